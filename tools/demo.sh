#!/usr/bin/env bash
# Installs what is missing, builds, and lets a statuette stand thirty years by the sea:
# six runs of the main job, and a contact sheet of their pictures.
set -euo pipefail
cd "$(dirname "$0")/.."
bash tools/setup.sh

cmake --preset release -DPATINA_BUILD_TESTS=OFF >/dev/null
cmake --build --preset release -j "$(nproc)" --target vdb-patina

out=demo-output
labels=()
pictures=()
for year in 00 06 12 18 24 30; do
  build/vdb-patina run "data/scripts/marine_$year.patina" statuette -o "$out/year_$year" --picture 480 --samples 24
  pictures+=("$out/year_$year/preview.png")
  labels+=(--label "$((10#$year)) years")
done
build/vdb-patina contact-sheet "${pictures[@]}" "${labels[@]}" --columns 3 --title "Copper by the sea" -o "$out/contact_sheet.png" -q

echo
echo "Thirty years by the sea: $out/contact_sheet.png"
echo "The last year's volume, maps, meshes, picture and report: $out/year_30/"
