#!/usr/bin/env bash
# Meshes of the shared data as the input, at any resolution: verified, and measured against what went
# in. Prints a Markdown table; fails where `voxweld verify` does.
# Usage: tests/mesh_acceptance.sh [RESOLUTION [SETTING...]]
#   RESOLUTION  cells along the longest side (default 1024; the ctest does 256)
#   SETTING     table.key=value for `voxweld run --set`: simplify.tolerance=0.01
# Environment: VOXWELD_BUILD (folder with voxweld and measure_mesh, default build),
# VOXWELD_SHARED_DATA (folder with meshes/), VOXWELD_SCRATCH (default a new folder below TMPDIR that
# is removed; some 100 MB).
set -euo pipefail
# shellcheck source=tests/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
build=${VOXWELD_BUILD:-$root/build}
data=${VOXWELD_SHARED_DATA:-$root/../shared/data}
resolution=${1:-1024}
shift || true
settings=()
for setting in "$@"; do settings+=(--set "$setting"); done
for program in voxweld measure_mesh; do
  require_program "$build/$program" "build it, or name its folder in VOXWELD_BUILD"
done

make_scratch

failures=0
echo "| mesh | seconds | verify | triangles | volume | vertices off: mean, most | mesh's: mean, most | sharp edges within 0.1 cells: share, mean, most | folded edges |"
echo "| --- | --- | --- | --- | --- | --- | --- | --- | --- |"
for name in fandisk.obj rocker-arm.obj anchor_dense.off joint.off knot2.off; do
  mesh=$data/meshes/$name
  if [ ! -f "$mesh" ]; then
    echo "| $name | not there | | | | | | | |"
    continue
  fi
  config=$scratch/${name%.*}.toml
  printf '[input]\npath = "%s"\nresolution = %s\n' "$mesh" "$resolution" >"$config"
  begin=$(date +%s.%N)
  "$build/voxweld" run "$config" ${settings[@]+"${settings[@]}"} >"$scratch/log" 2>&1 || {
    cat "$scratch/log" >&2
    exit 1
  }
  seconds=$(awk -v a="$begin" -v b="$(date +%s.%N)" 'BEGIN { printf "%.1f", b - a }')
  output=$scratch/${name%.*}.mesh
  good=good
  "$build/voxweld" verify "$output" >"$scratch/log" || {
    good=FAILED
    failures=$((failures + 1))
    cat "$scratch/log" >&2
  }
  "$build/measure_mesh" "$mesh" "$output" | awk -v name="$name" -v seconds="$seconds" -v good="$good" '
    /^[0-9]+ triangles to/ { split($0, f, "[ ;]+"); triangles = f[4]; volume = f[6] " %" }
    /^output.s vertices/ { gsub(/[,:]/, ""); there = $7 ", " $9 }
    /^mesh.s vertices/ { gsub(/[,:]/, ""); back = $7 ", " $9 }
    /^folded edges/ { gsub(/,/, ""); folded = $3 }
    /points of sharp edges/ { gsub(/[,:]/, ""); sharp = $13 " %, " $10 ", " $12 }
    END {
      printf "| %s | %s | %s | %s | %s | %s | %s | %s | %s |\n", name, seconds, good, triangles, volume,
        there, back, sharp == "" ? "none" : sharp, folded
    }'
  rm -rf "${config%.toml}.work"
done
[ "$failures" -eq 0 ]
