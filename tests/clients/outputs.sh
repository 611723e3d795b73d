#!/usr/bin/env bash
# Makes what the clients open: small enough to be drawn without a graphics card, with several levels of detail.
#   gyroid   all eight formats, 3 levels; in millimetres, at a distance from the origin
#   porous   .glb, 4 levels
#   pores    the same smaller as .meshopt.glb, which is all that its tileset has, 3 levels
#   cells    labels that share their triangles, with names and colours, 3 levels
#   grains   a mesh for each of some labels, 3 levels
#   rod      .glb, 6 levels, so many tiles that the tileset has nested files
#   bunny    the CT scan of the Stanford bunny, 3 levels; where the shared data is
#   frog     labels of a frog, that share their triangles; where the shared data is
# Does nothing where all of that is there. Prints nothing but what went wrong.
# Usage: outputs.sh PROGRAM FOLDER
set -euo pipefail
# shellcheck source=tests/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/../common.sh"
program=$(realpath "$1")
data=${VOXWELD_SHARED_DATA:-$root/../shared/data}
mkdir -p "$2"
cd "$2"

say() {
  "$program" "$@" >log.txt 2>&1 || {
    cat log.txt >&2
    exit 1
  }
}

# settings NAME INPUT_LINES TABLES: a config, and the run of it.
run_of() {
  printf '[input]\n%s\n%s\n' "$2" "$3" >"$1.toml"
  say run "$1.toml"
  say verify "$1.mesh" --no-merged
  rm -rf "$1.work"
}

half_phantom='[surface]
isovalue = 32767.5
inside = "below"'

made() { [ -f "$1.mesh/tileset.json" ]; }

made gyroid || {
  say phantom gyroid --size 128 --spacing 0.5 --unit mm --force -o gyroid.nrrd
  run_of gyroid 'path = "gyroid.nrrd"' "$half_phantom
[output]
levels = \"auto\"
tile_vertices = 4096
formats = [\"drc\", \"glb\", \"glb-plain\", \"meshopt\", \"ply\", \"stl\", \"obj\", \"vtp\"]"
}
# pores_of NAME SIZE FORMAT
pores_of() {
  say phantom porous --size "$2" --force -o "$1.nrrd"
  run_of "$1" "path = \"$1.nrrd\"" "$half_phantom
[output]
levels = \"auto\"
tile_vertices = 1024
formats = [\"$3\"]"
}
made porous || pores_of porous 160 glb
made pores || pores_of pores 96 meshopt
made rod || {
  say phantom porous --size 512 --force -o rod.nrrd
  run_of rod 'path = "rod.nrrd"
crop = [0, 0, 0, 512, 160, 160]' "$half_phantom
[simplify]
tolerance = 0.05
[output]
levels = \"auto\"
tile_vertices = 1024
merged = false
formats = [\"glb\"]"
  rm rod.nrrd
}
made cells || {
  say phantom labels --size 128 --spacing 0.5 --unit mm --force -o cells.nrrd
  # As many colours as there are labels, and neighbouring numbers far apart.
  awk 'BEGIN { print "label,name,color"; for (i = 1; i <= 216; ++i)
    printf "%d,cell %d,#%02x%02x%02x\n", i, i, 60 + (i * 89) % 190, 60 + (i * 137) % 190, 60 + (i * 53) % 190 }' >cells.csv
  run_of cells 'path = "cells.nrrd"' '[labels]
mode = "shared"
map = "cells.csv"
[output]
levels = "auto"
tile_vertices = 1024
formats = ["glb", "glb-plain", "meshopt"]'
}
made grains || {
  say phantom labels --size 96 --force -o grains.nrrd
  run_of grains 'path = "grains.nrrd"' '[labels]
mode = "each"
[output]
levels = "auto"
tile_vertices = 4096
formats = ["glb"]'
  rm grains.nrrd
}
ct=$data/bunny_ct/bunny_512x512x361_i16be.raw.xz
made bunny || [ ! -f "$ct" ] || {
  xz -dkc "$ct" >bunny.raw
  bunny_config bunny.raw >bunny.head
  run_of bunny "$(tail -n +2 bunny.head)" '[output]
levels = "auto"
tile_vertices = 16384
formats = ["glb", "meshopt"]'
  rm bunny.raw bunny.head
}
frog=$data/label/frogtissue.mhd
made frog || [ ! -f "$frog" ] || {
  run_of frog "path = \"$(realpath "$frog")\"" '[labels]
mode = "shared"
[output]
levels = "auto"
tile_vertices = 32768
formats = ["glb"]'
}
rm -f log.txt
