#!/usr/bin/env bash
# Prints a table, in Markdown, of the levels of detail of some volumes: triangles, megabytes of the .glb tiles, what
# voxweld states as error, and what VTK measures between each level and the finest, both ways. Beside each level
# stands what else has as few triangles: the finest mesh after meshoptimizer, a mesh of the volume at that scale
# (remeshed_level.py) after meshoptimizer, and a cut of the octree, not refined. Lengths are in the volume's unit: of
# phantoms voxels, of the bunny and the frog millimetres.
# Needs measure_output and meshopt_simplify in BUILD_DIR (default: build), VTK for Python, and for bunny and frog the
# shared data. With 512 samples a side it took six minutes.
# Usage: tests/clients/levels_table.sh [--size SAMPLES] [NAME ...]      (gyroid part porous bunny frog)
set -euo pipefail
# shellcheck source=tests/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/../common.sh"
build=$(realpath "${BUILD_DIR:-$root/build}")
data=${VOXWELD_SHARED_DATA:-$root/../shared/data}
size=512
if [ "${1:-}" = --size ]; then
  size=$2
  shift 2
fi
known="gyroid part porous bunny frog"
names=("$@")
[ $# -gt 0 ] || read -ra names <<<"$known"
require_known volume "$known" "${names[@]}"
for program in voxweld measure_output meshopt_simplify; do
  require_program "$build/$program" "build the target $program (meshopt_simplify needs libmeshoptimizer-dev)"
done
python=${PYTHON:-python3}
"$python" -c 'import vtkmodules' 2>/dev/null || python=/usr/bin/python3
export PYTHONDONTWRITEBYTECODE=1
make_scratch
cd "$scratch"

say() {
  "$build/voxweld" "$@" >log.txt 2>&1 || {
    cat log.txt >&2
    exit 1
  }
}

levels='[output]
levels = "auto"
formats = ["glb"]
merged = false
report = false'

echo "| volume | level | program | triangles | MB | stated | mean to finest | mean from finest | max to finest | max from finest | open edges | edges of more than 2 | intersecting pairs |"
echo "| --- | ---: | --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |"
for name in "${names[@]}"; do
  case $name in
    bunny)
      ct=$data/bunny_ct/bunny_512x512x361_i16be.raw.xz
      [ -f "$ct" ] || {
        echo "skipped: bunny: no shared data" >&2
        continue
      }
      xz -dkc "$ct" >bunny.raw
      { bunny_config bunny.raw && echo "$levels"; } >bunny.toml
      printf 'NRRD0004\ntype: short\ndimension: 3\nsizes: 512 512 361\nspacings: 0.337891 0.337891 0.5\nendian: big\nencoding: raw\ndata file: bunny.raw\n' >bunny.nhdr
      volume=(bunny.nhdr 1150 above)
      ;;
    frog)
      [ -f "$data/label/frogtissue.mhd" ] || {
        echo "skipped: frog: no shared data" >&2
        continue
      }
      printf '[input]\npath = "%s"\n[labels]\nmode = "shared"\n%s\n' "$(realpath "$data/label/frogtissue.mhd")" "$levels" >frog.toml
      volume=()
      ;;
    *)
      say phantom "$name" --size "$size" --type float32 -o "$name.nrrd"
      printf '[input]\npath = "%s.nrrd"\n[surface]\nisovalue = 0\ninside = "below"\n%s\n' "$name" "$levels" >"$name.toml"
      volume=("$name.nrrd" 0 below)
      ;;
  esac
  # Small tiles, or there would be one level only.
  case $name in gyroid | bunny | frog) tile=16384 ;; part) tile=1024 ;; *) tile=65536 ;; esac
  say run "$name.toml" --set "output.tile_vertices=$tile"
  [ ${#volume[@]} -eq 0 ] || say run "$name.toml" --set simplify.refine=off --set output.levels=1 --set output.directory=octree.mesh
  "$python" "$root/tests/clients/levels_table.py" "$name" "$name.mesh" "$build" "$scratch" "${volume[@]}"
  rm -rf "$name.nrrd" "$name.nhdr" "$name.raw" "$name.work" octree.mesh "$name"_*.ply
done
