#!/usr/bin/env bash
# Makes the packages and tries both as somebody does who has no compiler: the .deb installed by apt
# into a minimal system, and the image of a root file system. In each a scan becomes meshes, which
# are verified and drawn. Takes minutes and downloads packages; exits with 77 where there is no
# root or no mmdebstrap.
# Usage: tests/package_test.sh [BUILD]
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
build=$(cd "${1:-$root/build}" && pwd)
# shellcheck source=pipeline/debian_root.sh
source "$root/pipeline/debian_root.sh"
[ "$(id -u)" -eq 0 ] || exit 77
command -v mmdebstrap >/dev/null || exit 77

place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT
say() { printf '\n== %s (%s s)\n' "$*" "$SECONDS"; }
fail() {
  echo "package: $*" >&2
  exit 1
}

# inside ROOT COMMAND...: in a root file system, with /proc and /dev, which end with the command.
inside() {
  local at=$1
  shift
  # shellcheck disable=SC2016
  unshare --mount --pid --fork --mount-proc="$at/proc" sh -c \
    'mount --rbind /dev "$1/dev" && at=$1 && shift && exec chroot "$at" "$@"' sh "$at" "$@"
}

# make_mesh ROOT: what the quickstart does, with the installed program.
make_mesh() {
  local at=$1 compiler
  inside "$at" true || fail "the system cannot be entered"
  for compiler in cc g++ cmake; do
    inside "$at" sh -c "! command -v $compiler" || fail "a compiler is in the system"
  done
  mkdir -p "$at/try"
  if [ -r "$scan" ]; then
    cp "$scan" "$at/try/scan.nii.gz"
  else
    inside "$at" voxweld phantom gyroid --size 128 -o /try/scan.nrrd
  fi
  inside "$at" sh -ec 'cd /try; voxweld --version; voxweld init scan.*; voxweld run scan.toml
    voxweld verify scan.mesh; voxweld render scan.mesh -o scan.png; ls -l scan.png'
  [ -s "$at/try/scan.png" ] || fail "no picture"
}

scan=$({ dpkg -L mricron-data 2>/dev/null || true; } | grep -E '/ch2\.nii\.gz$' | head -n 1 || true)

say "packages"
BUILD=$build "$root/pipeline/package.sh" "$place/out"
dpkg-deb --info "$place"/out/*.deb
dpkg-deb --contents "$place"/out/*.deb
dpkg-deb -x "$place"/out/*.deb "$place/files"
for file in bin/voxweld lib/voxweld/libvoxweld_image.so \
  lib/voxweld/libvoxweld_tiff.so; do
  file "$place/files/usr/$file" | grep -q ', stripped' || fail "$file is not stripped"
done

say "the .deb in a minimal system"
debian_root "$place/clean"
cp "$place"/out/*.deb "$place/clean/voxweld.deb"
# What is installed by apt is what a user would install.
install() { # install PACKAGE...
  inside "$place/clean" sh -ec 'DEBIAN_FRONTEND=noninteractive apt-get -qq -y install "$@"
    dpkg --verify voxweld' sh "$@" >"$place/log" 2>&1 || { cat "$place/log"; fail "apt does not install it"; }
}
inside "$place/clean" apt-get -qq update
install --no-install-recommends /voxweld.deb
say "without what it recommends"
mapfile -t recommended < <(recommended_by "$place"/out/*.deb)
for library in libgdcm libhdf5 libopenvdb libopenimageio libcpp-httplib; do
  case ${recommended[*]} in *$library*) ;; *) fail "$library is not recommended: ${recommended[*]}" ;; esac
  inside "$place/clean" sh -c "! dpkg -l | grep -q '^ii  $library'" || fail "$library is installed"
done
inside "$place/clean" sh -ec 'mkdir -p /small; cd /small; voxweld phantom gyroid --size 64 -o a.nrrd
  voxweld init a.nrrd; voxweld run a.toml; voxweld verify a.mesh'
! inside "$place/clean" sh -ec 'cd /small; voxweld render a.mesh -o a.png' 2>"$place/log" ||
  fail "a picture without the library of pictures"
grep -q 'libvoxweld_image.so' "$place/log" || { cat "$place/log"; fail "what is missing is not said"; }
install --no-install-recommends "${recommended[@]}"
say "its mesh"
make_mesh "$place/clean"

say "the image"
mkdir "$place/image"
tar -C "$place/image" -xzf "$place"/out/*.tar.gz
make_mesh "$place/image"
cmp "$place/clean/try/scan.mesh/mesh.drc" "$place/image/try/scan.mesh/mesh.drc"
say "both in order"
