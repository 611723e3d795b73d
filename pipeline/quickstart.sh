#!/usr/bin/env bash
# From a bare Debian 12 to a mesh and a picture of it: installs packages, builds, turns a scan of a
# head into meshes, verifies and renders them, and makes a coarser one.
# Usage: pipeline/quickstart.sh [SCAN] [OUTPUT_DIR]
#   SCAN: any volume voxweld reads. Default: an MR scan of the package mricron-data, or where that
#   is missing a phantom. OUTPUT_DIR, default build/quickstart, is reused by the next run.
set -euo pipefail
case ${1:-} in -h | --help)
  sed -n '2,6s/^# //p' "$0"
  exit 0
  ;;
esac

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
build=$root/build
scan=${1:-}
output=${2:-$build/quickstart}

say() { printf '\n== %s\n' "$*"; }

say "packages"
"$root/pipeline/install_packages.sh"

say "build"
options=(-DCMAKE_BUILD_TYPE=Release)
# What tests need is not installed. Where they are built already they stay so.
[ -f "$build/CMakeCache.txt" ] || options+=(-DVOXWELD_TESTS=OFF)
cmake -S "$root" -B "$build" -G Ninja "${options[@]}" >/dev/null
cmake --build "$build" -j "$(nproc)" --target voxweld
voxweld=$build/voxweld

mkdir -p "$output"
find_scan() {
  # ch2: a head with its skin, air around it exactly zero.
  { dpkg -L mricron-data 2>/dev/null || true; } | grep -E '/ch2\.nii\.gz$' | head -n 1
}
if [ -z "$scan" ]; then
  scan=$(find_scan || true)
  if [ ! -r "$scan" ]; then
    say "no scan found: making a phantom"
    scan=$output/phantom.nrrd
    "$voxweld" phantom gyroid --size 256 --type uint16 -o "$scan" --force
  fi
fi

say "scan: $scan"
"$voxweld" init "$scan" -o "$output/quickstart.toml" --force
mesh=$output/mesh

say "run"
"$voxweld" run "$output/quickstart.toml" --set "output.directory=$mesh" \
  --set "work.directory=$output/work"

say "verify"
"$voxweld" verify "$mesh"

say "render"
"$voxweld" render "$mesh" -o "$output/mesh.png" --force --azimuth 205 --elevation 15

say "a coarser mesh, from what the run has left"
"$voxweld" extract "$output/quickstart.toml" --tolerance 0.5 -o "$output/coarse.glb" --force \
  --set "output.directory=$mesh" --set "work.directory=$output/work"

say "meshes"
find "$mesh" -type f \( -name '*.drc' -o -name '*.glb' \) -printf '%10s bytes  %p\n' | sort -k3
"$voxweld" info "$mesh"
printf '%10s bytes  %s\n' "$(stat -c %s "$output/mesh.png")" "$output/mesh.png"
