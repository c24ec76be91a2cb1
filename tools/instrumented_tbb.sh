#!/usr/bin/env bash
# Builds a oneTBB that the thread sanitizer can look into, from Debian's sources of the installed version, in
# build/instrumented-tbb, and prints the folder of its library. Does nothing where it is there already.
#
# Through the packaged library the sanitizer sees neither tasks being handed over nor waited for, and reports every
# parallel loop.
set -euo pipefail
cd "$(dirname "$0")/.."
root="$PWD/build/instrumented-tbb"

version="$(dpkg-query -W -f='${Version}' libtbb-dev)"
if [ "$(cat "$root/version" 2>/dev/null)" != "$version" ]; then
  rm -rf "$root"
  mkdir -p "$root/lists/partial" "$root/sources"
  # Where this machine's packages come from, their sources do: the same entries, in either of apt's formats.
  list="$root/sources.d"
  mkdir -p "$list"
  for file in /etc/apt/sources.list /etc/apt/sources.list.d/*.list; do
    [ -f "$file" ] && sed -n 's/^deb /deb-src /p' "$file" >> "$list/from_lines.list"
  done
  for file in /etc/apt/sources.list.d/*.sources; do
    [ -f "$file" ] && sed 's/^Types:.*/Types: deb-src/' "$file" > "$list/$(basename "$file")"
  done
  apt=(-o "Dir::Etc::sourcelist=/dev/null" -o "Dir::Etc::sourceparts=$list" -o "Dir::State::lists=$root/lists")
  apt-get "${apt[@]}" update -qq >&2 || true # entries of others may have no sources
  command -v dpkg-source >/dev/null || { echo "instrumented_tbb: dpkg-dev is missing; install it" >&2; exit 1; }
  (cd "$root/sources" && apt-get "${apt[@]}" source -qq "onetbb=$version" >&2)
  cmake -S "$root/sources"/onetbb-*/ -B "$root/build" -G Ninja -DCMAKE_BUILD_TYPE=RelWithDebInfo -DTBB_TEST=OFF -DTBB_STRICT=OFF \
    -DTBB_SANITIZE=thread -DCMAKE_CXX_FLAGS=-Wno-tsan >&2
  cmake --build "$root/build" --target tbb >&2
  echo "$version" > "$root/version"
fi
dirname "$(find "$root/build" -name 'libtbb.so.12' | head -1)"
