#!/usr/bin/env bash
# Gives what voxweld writes to programs that people use, and checks what they make of it. Prints a line for each
# client and each output; a client that is missing is skipped by name. Pictures stay in the folder.
#   tileset         tileset.json: schema, boxes, errors, closed at any mix of levels; distances by VTK
#   gltf            every .glb: the validator of Khronos, draco3dgltf, meshoptimizer
#   three           three.js in a headless Chromium: GLTFLoader, DRACOLoader, MeshoptDecoder
#   tiles-renderer  3d-tiles-renderer in the same
#   cesium          CesiumJS in the same, and labels by a click
#   neuroglancer    Neuroglancer in the same: exports with levels of bunny, frog, grains and gyroid
#   files           .ply, .stl, .obj, .vtp and .glb: VTK, Assimp, ADMesh, MeshLab, Blender: triangles, area, volume
# With --output it makes nothing: it looks at that output, of any size, by view (the page of `PROGRAM view`),
# tiles-renderer and cesium (large_client.mjs), and neuroglancer.
# Usage: tests/clients/run.sh [--output OUTPUT] [--only NAME[,NAME...]] PROGRAM OUT_FOLDER
# It installs nothing: tests/npm_packages.sh and tests/clients/install_packages.sh do.
# Exit status: 0 all is well (or skipped), 1 not so.
set -euo pipefail
# shellcheck source=tests/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/../common.sh"
known="tileset gltf three tiles-renderer cesium neuroglancer files"
output=
if [ "${1:-}" = --output ]; then
  output=$(realpath "${2:?an output folder}")
  known="view tiles-renderer cesium neuroglancer"
  shift 2
fi
clients=$known
if [ "${1:-}" = --only ]; then
  clients=${2//,/ }
  # shellcheck disable=SC2086 # names, which blanks part
  require_known client "$known" $clients
  shift 2
fi
[ $# -eq 2 ] || {
  echo "usage: tests/clients/run.sh [--output OUTPUT] [--only NAME[,NAME...]] PROGRAM OUT_FOLDER" >&2
  exit 2
}
require_program "$1" "build the target voxweld"
here=$root/tests/clients
mkdir -p "$2"
program=$(realpath "$1")
out=$(realpath "$2")
command -v node >/dev/null || {
  echo "no Node.js: tests/npm_packages.sh installs it" >&2
  exit 2
}
# Debian's packages are those of Debian's Python.
python=${PYTHON:-python3}
"$python" -c 'import vtkmodules' 2>/dev/null || python=/usr/bin/python3
export PYTHONDONTWRITEBYTECODE=1

outputs=()
if [ -z "$output" ]; then
  echo "outputs: making what is missing in $out"
  "$here/outputs.sh" "$program" "$out"
  for name in gyroid porous pores cells grains rod bunny frog; do
    if [ -d "$out/$name.mesh" ]; then outputs+=("$name"); else echo "skipped: $name (no shared data)"; fi
  done
elif [ ! -f "$output/tileset.json" ]; then
  echo "$output has no tileset.json: output.levels makes one" >&2
  exit 2
fi

labels() { case $1 in cells | grains | frog) echo --labels ;; esac; }

tileset() {
  local name status=0 one
  for name in "${outputs[@]}"; do
    one=0
    # shellcheck disable=SC2046 # an option or nothing
    node "$here/tileset_check.mjs" $(labels "$name") --dump "$out/tiles.$name" "$out/$name.mesh/tileset.json" || one=$?
    [ $one -ne 77 ] || return 77
    if [ $one -eq 0 ]; then "$python" "$here/tileset_distances.py" "$out/tiles.$name" || one=$?; fi
    rm -rf "$out/tiles.$name"
    [ $one -eq 0 ] || [ $one -eq 77 ] || status=1
  done
  return $status
}
gltf() {
  local folders=("${outputs[@]/#/$out/}")
  node "$here/gltf_check.mjs" "${folders[@]/%/.mesh}"
}
three() { node "$here/three_client.mjs" "$out" "${outputs[@]}"; }
tiles-renderer() { node "$here/tiles_renderer_client.mjs" "$out" "${outputs[@]}"; }
cesium() { node "$here/cesium_client.mjs" "$out" "${outputs[@]}"; }
neuroglancer() {
  local name shown=()
  for name in "${outputs[@]}"; do
    case $name in gyroid | grains | bunny | frog) shown+=("$out/$name.mesh") ;; esac
  done
  node "$here/neuroglancer_client.mjs" "$program" "$out" "${shown[@]}"
}
files() { "$python" "$here/mesh_files.py" "$out/gyroid.mesh"; }

failed=()
skipped=()
for client in $clients; do
  echo "== $client"
  status=0
  if [ -z "$output" ]; then
    "$client"
  elif [ "$client" = neuroglancer ]; then
    node "$here/neuroglancer_client.mjs" "$program" "$out" "$output"
  else
    node "$here/large_client.mjs" "$client" "$program" "$output" "$out"
  fi || status=$?
  case $status in
    0) ;;
    77) skipped+=("$client") ;;
    *) failed+=("$client") ;;
  esac
done
echo "clients: $(wc -w <<<"$clients"), skipped: ${skipped[*]:-none}, failed: ${failed[*]:-none}"
[ ${#failed[@]} -eq 0 ]
