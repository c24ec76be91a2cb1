#!/usr/bin/env bash
# Installs what is missing, builds and runs the tests.
#
#   tools/test.sh               the default tests (all but those labelled slow or clients), warnings are errors
#   tools/test.sh --slow        the slow ones and those that run other programs (Blender) as well
#   tools/test.sh --only-slow   those alone, after a run of the default ones
#   tools/test.sh --sanitize    the default tests under the address and undefined-behaviour sanitizers
set -euo pipefail
cd "$(dirname "$0")/.."

preset=release
setup=()
select=(-LE 'slow|clients')
for option in "$@"; do
  case "$option" in
    --slow) select=(); setup=(--clients) ;;
    --only-slow) select=(-L 'slow|clients'); setup=(--clients) ;;
    --sanitize) preset=sanitize ;;
    *) echo "test.sh: unknown option '$option' (--slow, --only-slow, --sanitize)" >&2; exit 2 ;;
  esac
done

bash tools/setup.sh "${setup[@]}"
cmake --preset "$preset" -DPATINA_BUILD_TESTS=ON -DPATINA_WARNINGS_AS_ERRORS=ON
cmake --build --preset "$preset" -j "$(nproc)"
ctest --preset "$preset" --no-tests=error -j "$(nproc)" "${select[@]}"
