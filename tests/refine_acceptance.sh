#!/usr/bin/env bash
# Refines phantoms, real scans, labels and meshes, and checks what comes out with `voxweld verify`.
# Prints a Markdown table of triangles, of pairs of them that intersect, of triangles without an area and
# of edges at a border. Fails where verify does, as for edges and vertices that are not manifold, or where
# the manifest has another number of pairs. What has no data is skipped, and told.
# Usage: tests/refine_acceptance.sh [CASE...]    (default: all)
#   CASE  sphere torus gyroid part porous temple noise bunny scans labels meshes random
# Environment: VOXWELD (the program, default build/voxweld), VOXWELD_SHARED_DATA (folder with
# bunny_ct/, label/, meshes/, nifti/ and vtk/), VOXWELD_SCRATCH (default a new folder below TMPDIR that
# is removed; needs some GB), VOXWELD_SIZE (samples a side of the phantoms, default 512; noise has a
# quarter of that), VOXWELD_MODES (default "collapse repair"), VOXWELD_RANDOM (how many random volumes,
# default 1000: noise and porous ones by turns, 24 to 48 samples a side, at three tolerances each).
set -euo pipefail
# shellcheck source=tests/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
voxweld=${VOXWELD:-$root/build/voxweld}
data=${VOXWELD_SHARED_DATA:-$root/../shared/data}
size=${VOXWELD_SIZE:-512}
known=(sphere torus gyroid part porous temple noise bunny scans labels meshes random)
cases=("$@")
[ $# -gt 0 ] || cases=("${known[@]}")
require_known case "${known[*]}" "${cases[@]}"
require_program "$voxweld" "build it, or name it in VOXWELD"

make_scratch

failures=0
failed() {
  echo "| $1 | FAILED: $2 |"
  failures=$((failures + 1))
}

# number FILE KEY: the first number with that key in a JSON file.
number() { grep -oE "\"$2\": ?[0-9]+" "$1" | head -n 1 | grep -oE '[0-9]+$'; }

# refined NAME CONFIG [SETTING...]: its text is in CONFIG.
refined() {
  local name=$1 config=$2 mode pairs left seconds begin setting more=()
  for setting in "${@:3}"; do more+=(--set "$setting"); done
  for mode in ${VOXWELD_MODES:-collapse repair}; do
    rm -rf "$scratch/work" "$scratch/mesh"
    begin=$(date +%s.%N)
    if ! "$voxweld" run "$config" --log-level warning --set simplify.refine="$mode" "${more[@]}" \
      --set work.directory="$scratch/work" --set output.directory="$scratch/mesh" \
      >"$scratch/out" 2>"$scratch/err"; then
      if grep -q 'no surface' "$scratch/err"; then
        echo "| $name, $mode | skipped: no surface |"
      else
        failed "$name, $mode" "$(tail -n 1 "$scratch/err")"
      fi
      continue
    fi
    seconds=$(awk -v a="$begin" -v b="$(date +%s.%N)" 'BEGIN { printf "%.1f", b - a }')
    if ! "$voxweld" verify "$scratch/mesh" --no-origin --intersections --json \
      >"$scratch/verify.json" 2>"$scratch/err"; then
      failed "$name, $mode" "verify: $(grep -o '"problems":.*' "$scratch/verify.json" | head -c 300)"
      continue
    fi
    pairs=$(number "$scratch/verify.json" intersecting_pairs)
    left=$(number "$scratch/mesh/manifest.json" intersecting_left)
    [ "$pairs" = "$left" ] || failed "$name, $mode" "$pairs pairs, and $left by the manifest"
    echo "| $name, $mode | $(number "$scratch/verify.json" triangles) |" \
      "$(number "$scratch/mesh/manifest.json" intersecting_before) | $pairs |" \
      "$(number "$scratch/verify.json" degenerate_triangles) |" \
      "$(number "$scratch/verify.json" boundary_edges) | $seconds s |"
  done
}

phantom() {
  local file=$scratch/$1.nrrd samples=$size more=()
  if [ "$1" = noise ]; then  # the fullest cubes there are, in little memory
    samples=$((size / 4))
    more=(run.memory=256MiB)
  fi
  "$voxweld" phantom "$1" --size "$samples" --type float32 -o "$file" --force --log-level quiet >/dev/null
  printf '[input]\npath = "%s"\n[surface]\nisovalue = 0\ninside = "below"\n' "$file" \
    >"$scratch/$1.toml"
  refined "$1 $samples^3" "$scratch/$1.toml" "${more[@]}"
  rm -f "$file"
}

bunny() {
  local packed=$data/bunny_ct/bunny_512x512x361_i16be.raw.xz
  if [ ! -r "$packed" ]; then
    echo "| bunny | skipped: needs $packed |"
    return
  fi
  xz -dc "$packed" >"$scratch/bunny.raw"
  bunny_config "$scratch/bunny.raw" >"$scratch/bunny.toml"
  refined "bunny CT" "$scratch/bunny.toml"
  rm -f "$scratch/bunny.raw"
}

# of_file NAME LINES: `voxweld init` finds the isovalue where LINES has none.
of_file() {
  local file=$1 name config=$scratch/file.toml
  name=$(basename "$file")
  if [ ! -r "$file" ]; then
    echo "| $name | skipped: needs $file |"
    return
  fi
  if [ -n "$2" ]; then
    printf '[input]\npath = "%s"\n%s' "$file" "$2" >"$config"
  elif ! "$voxweld" init "$file" -o "$config" --force --log-level quiet >/dev/null 2>"$scratch/err"; then
    failed "$name" "init: $(tail -n 1 "$scratch/err")"
    return
  fi
  refined "$name${2:+ ($(head -n 1 <<<"$3"))}" "$config"
}

scans() {
  local name
  for name in engine bonsai CT_pitch chris_PD fuel Iguana; do of_file "$data/nifti/$name.nii.gz" '' ''; done
  of_file "$data/vtk/HeadMRVolume.mhd" '' ''
}

labels() {
  local mode
  for mode in each shared; do
    of_file "$data/label/frogtissue.mhd" $'[labels]\nmode = "'$mode$'"\n' $mode
    of_file "$data/label/liver.inr.gz" $'[labels]\nmode = "'$mode$'"\n' $mode
  done
}

meshes() {
  local name
  for name in fandisk.obj rocker-arm.obj anchor_dense.off joint.off knot2.off; do
    of_file "$data/meshes/$name" $'resolution = 512\n' '512 cells'
  done
}

# One line for each kind, mode and tolerance: sums over all volumes.
random() {
  local kind tolerance i rows=$scratch/random.rows
  for kind in noise porous; do
    for tolerance in 0.05 0.3 1e9; do
      for ((i = 0; i < ${VOXWELD_RANDOM:-1000} / 2; ++i)); do
        "$voxweld" phantom $kind --size $((24 + i % 25)) --seed $((i + 1)) --type float32 \
          -o "$scratch/random.nrrd" --force --log-level quiet >/dev/null
        printf '[input]\npath = "%s"\n[surface]\nisovalue = 0\ninside = "below"\n' \
          "$scratch/random.nrrd" >"$scratch/random.toml"
        refined "$kind $((i + 1)), tolerance $tolerance" "$scratch/random.toml" \
          simplify.tolerance=$tolerance run.threads=1
      done >"$rows"
      grep FAILED "$rows" || true
      sum_rows "$kind" $tolerance <"$rows"
    done
  done
}

# sum_rows KIND TOLERANCE: of rows as refined() prints them.
sum_rows() {
  awk -F'|' -v kind="$1" -v tolerance="$2" '
    /FAILED|skipped/ { next }
    { split($2, name, ", "); mode = name[3]; gsub(/ /, "", mode); ++runs[mode]
      for (i = 3; i <= 7; ++i) sums[mode, i] += $i
      seconds[mode] += $8
      if ($5 > 0) ++with[mode] }
    END { for (mode in runs)
      printf "| %s, %d volumes (%d with pairs), tolerance %s, %s | %d | %d | %d | %d | %d | %.0f s |\n",
        kind, runs[mode], with[mode], tolerance, mode, sums[mode, 3], sums[mode, 4], sums[mode, 5],
        sums[mode, 6], sums[mode, 7], seconds[mode] }'
}

echo "| volume, refine | triangles | pairs before | pairs | degenerate | border | time |"
echo "| --- | ---: | ---: | ---: | ---: | ---: | ---: |"
for one in "${cases[@]}"; do
  case $one in
    bunny | scans | labels | meshes | random) "$one" ;;
    *) phantom "$one" ;;
  esac
done
[ "$failures" -eq 0 ] || {
  echo "$failures failed" >&2
  exit 1
}
