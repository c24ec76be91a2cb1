#!/bin/bash
# The five growth models on one model, early, in the middle and late, on one sheet (docs/growth.md).
#
#   bash tools/growth_pictures.sh [MODEL] [FOLDER] [OPTION of run ...]
#
# MODEL: a file, or a shape of `vdb-patina make` (default plate); FOLDER: for the sheet and what it is made of (default
# growth-pictures); any further options go to `run` (--voxels 256 --azimuth 30 ...). PATINA names another program.
set -euo pipefail
model=${1:-plate}
folder=${2:-growth-pictures}
shift $(($# < 2 ? $# : 2))
program=${PATINA:-$(dirname "$0")/../build/vdb-patina}
mkdir -p "$folder"
pictures=() labels=()
for growth in ST RD RDR BD DPD; do
    for step in 2 8 20; do
        name=${growth}_$step
        cat >"$folder/$name.patina" <<SCRIPT
new copper
coat cuprite_2 0.6um
coat brochantite 12um texture($growth(rate=linear, step=$step, total=20) of full)
SCRIPT
        "$program" run "$folder/$name.patina" "$model" --picture 320 --samples 32 --resolution 64 --quiet "$@" -o "$folder/$name"
        pictures+=("$folder/$name/preview.png")
        labels+=(--label "$growth, step $step of 20")
    done
done
"$program" contact-sheet "${pictures[@]}" "${labels[@]}" --columns 3 -o "$folder/sheet.png"
