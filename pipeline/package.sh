#!/usr/bin/env bash
# Packages voxweld: a .deb of it, and the image of a root file system that has it installed, for
# machines where nobody is root. Builds what is missing first. Needs root, dpkg-dev, file and
# mmdebstrap; takes packages from where this machine's apt takes them. Where Node.js's npm is there
# too, both have the page of `voxweld view`.
# Usage: pipeline/package.sh [OUT]
#   OUT, default build/package, gets voxweld_VERSION_ARCH.deb and voxweld_VERSION_ARCH.tar.gz.
#   BUILD in the environment names the build folder, default build.
# The .deb:   apt install ./voxweld_*.deb
#             (with --no-install-recommends it comes without the libraries of some formats)
# The image:  mkdir voxweld && tar -C voxweld -xf voxweld_*.tar.gz
#             apptainer exec voxweld voxweld --help
#             (or, as root and with /proc mounted in it: chroot voxweld voxweld --help)
#             docker import voxweld_*.tar.gz voxweld && docker run voxweld voxweld --help
set -euo pipefail
case ${1:-} in -h | --help)
  sed -n '2,15s/^# //p' "$0"
  exit 0
  ;;
esac

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
build=${BUILD:-$root/build}
out=${1:-$build/package}
mkdir -p "$out"
out=$(cd "$out" && pwd)
# shellcheck source=pipeline/debian_root.sh
source "$root/pipeline/debian_root.sh"

for tool in mmdebstrap dpkg-shlibdeps file; do
  command -v "$tool" >/dev/null || {
    echo "package: $tool is missing; install mmdebstrap, dpkg-dev and file" >&2
    exit 1
  }
done
[ "$(id -u)" -eq 0 ] || {
  echo "package: run as root: the image is a root file system" >&2
  exit 1
}

[ -f "$build/CMakeCache.txt" ] ||
  cmake -S "$root" -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release >/dev/null
cmake --build "$build" --target voxweld_package_files -j "$(nproc)"
rm -f "$out"/voxweld_*.deb "$out"/voxweld_*.tar.gz
(cd "$build" && cpack -G DEB -B "$out") >/dev/null
rm -rf "$out/_CPack_Packages"
deb=$(echo "$out"/voxweld_*.deb)
image=${deb%.deb}.tar.gz

# The library that reads images links what shows them, yet nothing here asks for the drivers of
# graphics cards.
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT
# What it recommends too, and not what that recommends.
recommended=$(recommended_by "$deb" | paste -sd' ')
# shellcheck disable=SC2016
debian_root "$place/root" \
  --dpkgopt='path-exclude=/usr/lib/*/dri/*' --dpkgopt='path-exclude=/usr/lib/*/libLLVM*' \
  --dpkgopt='path-exclude=/usr/lib/*/libz3.so*' --dpkgopt='path-exclude=/usr/lib/*/*mfx*hw64*' \
  --customize-hook="upload $deb /tmp/voxweld.deb" \
  --customize-hook='chroot "$1" apt-get -qq -y install /tmp/voxweld.deb '"$recommended"' >/dev/null' \
  --customize-hook='rm "$1"/tmp/voxweld.deb "$1"/etc/apt/apt.conf.d/99mmdebstrap' \
  --customize-hook='rm -f "$1"/etc/resolv.conf "$1"/etc/hostname'
# Device nodes only root can unpack; who enters the image brings /dev along.
tar -C "$place/root" --sort=name --numeric-owner --exclude='./dev/*' -czf "$image" .
ls -l "$deb" "$image"
