#!/usr/bin/env bash
# Builds and runs tests under the sanitizers: the rooms that read what users give and those that hold most arithmetic
# under the address and undefined-behaviour sanitizers, and what runs in parallel under the thread sanitizer, with a
# oneTBB that is instrumented as well. `tools/test.sh --sanitize` runs every default test under the first two; it takes
# an hour on two cores.
set -euo pipefail
cd "$(dirname "$0")/.."

bash tools/setup.sh --thread-sanitizer

cmake --preset sanitize -DPATINA_BUILD_TESTS=ON -DPATINA_WARNINGS_AS_ERRORS=ON
cmake --build --preset sanitize -j "$(nproc)" --target base_tests surface_tests optics_tests volume_tests fields_tests growth_tests
for room in base surface optics volume fields growth; do
  "build/sanitize/tests/${room}_tests" --gtest_brief=1
done

if ! tbb="$(bash tools/instrumented_tbb.sh)"; then
  echo "sanitize: the thread sanitizer is left out, because the sources of oneTBB cannot be had from this machine's package sources" >&2
  exit 0
fi
cmake --preset thread-sanitize -DPATINA_BUILD_TESTS=ON -DPATINA_WARNINGS_AS_ERRORS=ON
cmake --build --preset thread-sanitize -j "$(nproc)" --target growth_tests
TSAN_OPTIONS="suppressions=$PWD/tests/thread_sanitizer.supp" LD_LIBRARY_PATH="$tbb" \
  build/thread-sanitize/tests/growth_tests --gtest_brief=1 --gtest_filter='*Threads*:GrowthScale.*'
