#!/usr/bin/env bash
# Installs the Debian packages that building and testing need. Does nothing where all are there.
#
#   tools/setup.sh              what building and the default tests need
#   tools/setup.sh --clients    also what reads our files in the tests labelled clients: Blender, OpenVDB's tools and its
#                               Python module, a GLSL compiler, and USD and MaterialX for Python in the virtual
#                               environment build/clients-venv
set -euo pipefail

packages=(
  build-essential cmake ninja-build pkg-config git ca-certificates
  libopenvdb-dev libboost-dev libboost-iostreams-dev libtbb-dev
  libopenexr-dev libimath-dev libopenimageio-dev
  libopenmesh-dev libembree-dev libosd-dev
  tao-pegtl-dev libcli11-dev libspdlog-dev libfmt-dev
  libtomlplusplus-dev nlohmann-json3-dev librandom123-dev libxxhash-dev libdeflate-dev libeigen3-dev
  libgtest-dev libgmock-dev libbenchmark-dev
  fonts-dejavu-core python3
)

clients=no
for option in "$@"; do
  case "$option" in
    --clients) packages+=(blender glslang-tools python3-venv python3-openvdb python3-numpy libopenvdb-tools); clients=yes ;;
    --thread-sanitizer) packages+=(dpkg-dev) ;;
    *) echo "setup.sh: unknown option '$option' (--clients, --thread-sanitizer)" >&2; exit 2 ;;
  esac
done

missing=()
for package in "${packages[@]}"; do
  dpkg-query -W -f='${Status}' "$package" 2>/dev/null | grep -q 'install ok installed' || missing+=("$package")
done
if [ "${#missing[@]}" != 0 ]; then
  as_root=()
  if [ "$(id -u)" != 0 ]; then
    command -v sudo >/dev/null || { echo "setup: these packages are missing: ${missing[*]}; install them as root" >&2; exit 1; }
    as_root=(sudo)
  fi
  echo "setup: installing ${missing[*]}" >&2
  "${as_root[@]}" apt-get update -qq >&2
  DEBIAN_FRONTEND=noninteractive "${as_root[@]}" apt-get install -y -qq --no-install-recommends "${missing[@]}" >&2
fi

# Python packages, where the list has changed since they were installed. Debian's own python3: another one on PATH may go away.
if [ "$clients" = yes ]; then
  root="$(cd "$(dirname "$0")/.." && pwd)"
  list="$root/tests/clients/requirements.txt" venv="$root/build/clients-venv"
  if ! cmp -s "$list" "$venv/requirements.txt"; then
    echo "setup: installing $(grep -v '^#' "$list" | tr '\n' ' ')" >&2
    /usr/bin/python3 -m venv --clear "$venv"
    "$venv/bin/python3" -m pip install -q --disable-pip-version-check -r "$list" >&2
    cp "$list" "$venv/requirements.txt"
  fi
fi
