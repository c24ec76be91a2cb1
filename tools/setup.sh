#!/usr/bin/env bash
# Installs the Debian packages that building and testing need. Does nothing where all are there.
#
#   tools/setup.sh              what building and the default tests need
#   tools/setup.sh --clients    also the programs that read our files in the tests labelled clients (Blender)
set -euo pipefail

packages=(
  build-essential cmake ninja-build pkg-config git ca-certificates
  libopenvdb-dev libboost-dev libboost-iostreams-dev libtbb-dev
  libopenexr-dev libimath-dev libopenimageio-dev
  libopenmesh-dev libembree-dev libosd-dev
  tao-pegtl-dev libcli11-dev libspdlog-dev libfmt-dev
  libtomlplusplus-dev nlohmann-json3-dev librandom123-dev libxxhash-dev libeigen3-dev
  libgtest-dev libgmock-dev libbenchmark-dev
  fonts-dejavu-core python3
)

for option in "$@"; do
  case "$option" in
    --clients) packages+=(blender) ;;
    *) echo "setup.sh: unknown option '$option' (--clients)" >&2; exit 2 ;;
  esac
done

missing=()
for package in "${packages[@]}"; do
  dpkg-query -W -f='${Status}' "$package" 2>/dev/null | grep -q 'install ok installed' || missing+=("$package")
done
[ "${#missing[@]}" = 0 ] && exit 0

as_root=()
if [ "$(id -u)" != 0 ]; then
  command -v sudo >/dev/null || { echo "setup: these packages are missing: ${missing[*]}; install them as root" >&2; exit 1; }
  as_root=(sudo)
fi
echo "setup: installing ${missing[*]}" >&2
"${as_root[@]}" apt-get update -qq >&2
DEBIAN_FRONTEND=noninteractive "${as_root[@]}" apt-get install -y -qq --no-install-recommends "${missing[@]}" >&2
