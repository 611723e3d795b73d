#!/usr/bin/env bash
# Draws a set of pictures with `voxweld render`: of phantoms, and of scans where the shared data is. The
# pictures of README.md beside this script are made by it. What is there already is not made again.
# Usage: pipeline/output/gallery.sh [PROGRAM [FOLDER]]
#   PROGRAM: default build/voxweld. FOLDER, default build/gallery, gets the pictures, the volumes and the meshes.
#   VOXWELD_SHARED_DATA: the folder of the scans; default ../shared/data beside this repository.
set -euo pipefail
case ${1:-} in -h | --help)
  sed -n '2,6s/^# //p' "$0"
  exit 0
  ;;
esac

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
program=$(realpath "${1:-$root/build/voxweld}")
folder=${2:-$root/build/gallery}
data=${VOXWELD_SHARED_DATA:-$root/../shared/data}
[ ! -d "$data" ] || data=$(realpath "$data")
mkdir -p "$folder"
cd "$folder"

# Tells what a command says only where it fails.
quiet() {
  "$program" "$@" >log.txt 2>&1 || {
    cat log.txt >&2
    exit 1
  }
}

# mesh NAME INPUT_LINES TABLES: a config, and its run.
mesh() {
  [ ! -f "$1.mesh/manifest.json" ] || return 0
  printf '[input]\n%s\n%s\n[output]\nreport = false\n%s\n' "$2" "$3" "${4:-}" >"$1.toml"
  quiet run "$1.toml"
  rm -rf "$1.work"
}

# phantom NAME KIND SIZE OPTIONS...
phantom() {
  [ -f "$1.nrrd" ] || quiet phantom "$2" --size "$3" --force -o "$1.nrrd" "${@:4}"
}

# picture NAME MESH OPTIONS...
picture() {
  quiet render "$2.mesh" -o "$1.png" --force --width 300 --height 280 "${@:3}"
  echo "$folder/$1.png"
}

known='[surface]
isovalue = 32767.5
inside = "below"'

phantom gyroid gyroid 128
mesh gyroid 'path = "gyroid.nrrd"' "$known"
picture gyroid gyroid --cut-y 64 --azimuth 160 --zoom 1.35

phantom small gyroid 64
mesh small 'path = "small.nrrd"' "$known" 'levels = "auto"
tile_vertices = 1024'
for level in 0 1; do
  picture "level$level" small --edges --azimuth 20 --zoom 1.35 --level "$level"
done

phantom part part 256
mesh part 'path = "part.nrrd"' "$known"
picture part part --azimuth 40 --elevation 35 --zoom 1.3
picture part_edges part --azimuth 40 --elevation 35 --zoom 1.3 --edges

phantom temple temple 192
mesh temple 'path = "temple.nrrd"' "$known"
picture temple temple --azimuth 30 --elevation 20 --zoom 1.1

phantom porous porous 96
mesh porous 'path = "porous.nrrd"' "$known"
picture porous porous --azimuth 30 --elevation 25

phantom cells labels 128 --type uint16
mesh cells 'path = "cells.nrrd"' '[labels]
mode = "shared"'
picture cells cells --cut-y 66 --azimuth 160 --zoom 1.35

if [ -f "$data/label/frogtissue.mhd" ]; then
  mesh frog "path = \"$data/label/frogtissue.mhd\"" '[labels]
mode = "shared"' 'formats = ["drc"]'
  picture frog frog --azimuth 30 --elevation 50
fi
if [ -f "$data/nifti/engine.nii.gz" ]; then
  mesh engine "path = \"$data/nifti/engine.nii.gz\"" '[surface]
isovalue = 70' 'formats = ["drc"]'
  picture engine engine --azimuth 30 --elevation 30 --zoom 1.05
fi
rm -f log.txt
