#!/usr/bin/env bash
# The long matrix on real data and large phantoms: what the tests check on small volumes, at size.
# Usage: tests/acceptance.sh [STEP...]        (default: all; a table of results at the end)
#   partition   the bunny CT: chunk, brick, shard, threads and copy, all to the same bytes
#   kills       the bunny CT: a run killed 20 times and resumed, the same bytes, nothing left over
#   tiles       the bunny CT: the merged mesh is the same for any output.tile_vertices
#   labels      frogtissue in both modes, with edits: partitions, kills and verify
#   edits       the bunny CT with solids added and taken away: the same
#   mesh        rocker-arm as the input, 512 cells long, with an edit: the same
#   phantoms    gyroid, part, porous and temple of 512^3: verify finds nothing
#   memory      gyroid and part of 1024^3, noise of 512^3 under run.memory = 512MiB: peak below it
#   figures     gyroid, part and noise of 512^3 at run.memory = 256MiB: seconds and peak
# Environment: VOXWELD (the program, default build/voxweld), VOXWELD_SHARED_DATA (folder with
# bunny_ct/, label/ and meshes/), VOXWELD_SCRATCH (where about 10 GB may be written, default a new folder below TMPDIR
# that is removed), VOXWELD_KILLS (default 20), VOXWELD_SEED (default 1).
set -euo pipefail
# shellcheck source=tests/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
voxweld=${VOXWELD:-$root/build/voxweld}
data=${VOXWELD_SHARED_DATA:-$root/../shared/data}
kills=${VOXWELD_KILLS:-20}
RANDOM=${VOXWELD_SEED:-1}
known=(partition kills tiles labels edits mesh phantoms memory figures)
steps=("$@")
[ $# -gt 0 ] || steps=("${known[@]}")
require_known step "${known[*]}" "${steps[@]}"
require_program "$voxweld" "build it, or name it in VOXWELD"

make_scratch

rows=()
failures=0
# report STEP CASE RESULT [DETAIL]
report() {
  rows+=("$(printf '%-10s %-44s %-8s %s' "$1" "$2" "$3" "${4:-}")")
  echo "${rows[-1]}"
  [ "$3" != FAILED ] || failures=$((failures + 1))
}

now() { date +%s.%N; }
since() { awk -v a="$1" -v b="$(now)" 'BEGIN { printf "%.1f", b - a }'; }

temporaries() { find "$@" -name '*.tmp-*' | wc -l; }

# arguments NAME [SETTING...]: of a run of the step's config into directories of that name.
config=
arguments() {
  local name=$1 setting
  shift
  args=(run "$config" --log-level warning)
  for setting in "work.directory=$scratch/$name.work" "output.directory=$scratch/$name.mesh" "$@"; do
    args+=(--set "$setting")
  done
}
run() {
  arguments "$@"
  "$voxweld" "${args[@]}" >"$scratch/$1.out" 2>"$scratch/$1.err"
}
forget() { rm -rf "$scratch/$1.work" "$scratch/$1.mesh"; }

# Unpacks the bunny and makes its config; false, with the reason in `missing`, where it cannot.
missing=
bunny() {
  local packed=$data/bunny_ct/bunny_512x512x361_i16be.raw.xz
  if [ ! -r "$packed" ]; then
    missing="needs $packed"
    return 1
  fi
  if ! command -v xz >/dev/null; then
    missing="needs xz"
    return 1
  fi
  config=$scratch/bunny.toml
  [ -f "$scratch/bunny.raw" ] || {
    xz -dc "$packed" >"$scratch/bunny.raw.part"
    mv "$scratch/bunny.raw.part" "$scratch/bunny.raw"
  }
  bunny_config "$scratch/bunny.raw" >"$config"
}

# A config of its own needs a reference of its own.
reference=
reference_of=
make_reference() {
  [ "$reference_of" != "$config" ] || return 0
  reference_of=$config
  forget reference
  run reference || {
    cat "$scratch/reference.err" >&2
    exit 1
  }
  reference=$(tree_hash "$scratch/reference.mesh")
}

# expect_reference STEP CASE [SETTING...]: a fresh run with these gives the reference's bytes.
expect_reference() {
  local step=$1 case=$2 begin
  shift 2
  begin=$(now)
  if ! run variant "$@"; then
    report "$step" "$case" FAILED "$(tail -n 1 "$scratch/variant.err")"
  elif [ "$(tree_hash "$scratch/variant.mesh")" != "$reference" ]; then
    report "$step" "$case" FAILED "other bytes"
  else
    report "$step" "$case" same "$(since "$begin") s"
  fi
  forget variant
}

step_partition() {
  make_reference
  local turn=0 copy brick shard chunk threads
  for copy in false true; do
    for brick in 16 32 64 128; do
      for shard in 1 2 4; do
        # Chunks take turns and divide shards; without a copy there are none.
        chunk=$((16 << ((turn + turn / 3) % 3)))
        [ $chunk -le $((brick * shard)) ] || chunk=$((brick * shard))
        threads=$((1 + turn % 2))
        turn=$((turn + 1))
        expect_reference partition \
          "brick $brick, shard $shard, chunk $chunk, threads $threads, copy $copy" \
          work.brick=$brick work.shard=$shard work.chunk=$chunk run.threads=$threads work.copy=$copy
      done
    done
  done
}

# expect_reference_after_kills STEP CASE [SETTING...]: killed again and again, then left alone.
expect_reference_after_kills() {
  local step=$1 case=$2 begin whole after killed=0 child i
  shift 2
  begin=$(now)
  run timing "$@"
  whole=$(since "$begin")
  forget timing
  for ((i = 0; i < kills; ++i)); do
    # Each run may go on for up to a quarter of a whole one, so that all stages are met.
    after=$(awk -v w="$whole" -v r="$RANDOM" 'BEGIN { printf "%.3f", w / 4 * r / 32768 }')
    arguments killed "$@"
    "$voxweld" "${args[@]}" >/dev/null 2>&1 &
    child=$!
    sleep "$after"
    kill -KILL $child 2>/dev/null || true
    if wait $child 2>/dev/null; then forget killed; else killed=$((killed + 1)); fi
  done
  if ! run killed "$@"; then
    report "$step" "$case" FAILED "$(tail -n 1 "$scratch/killed.err")"
  elif [ "$(tree_hash "$scratch/killed.mesh")" != "$reference" ]; then
    report "$step" "$case" FAILED "other bytes after $killed kills"
  elif [ "$(temporaries "$scratch/killed.work" "$scratch/killed.mesh")" -ne 0 ]; then
    report "$step" "$case" FAILED "temporaries left after $killed kills"
  else
    report "$step" "$case" same "$killed of $kills runs killed; a whole one takes $whole s"
  fi
  forget killed
}

step_kills() {
  make_reference
  local copy
  for copy in false true; do
    expect_reference_after_kills kills "copy $copy" work.copy=$copy
  done
}

# everything STEP NAME: of the config, verify, some partitions and kills.
everything() {
  make_reference
  if "$voxweld" verify "$scratch/reference.mesh" >"$scratch/verify.out" 2>&1; then
    report "$1" "$2" clean "$(head -n 1 "$scratch/verify.out")"
  else
    report "$1" "$2" FAILED "verify: $(tail -n 1 "$scratch/verify.out")"
  fi
  expect_reference "$1" "$2, brick 16, shard 4, threads 1" \
    work.brick=16 work.shard=4 run.threads=1
  expect_reference "$1" "$2, brick 32, shard 1, copy" \
    work.brick=32 work.shard=1 work.chunk=16 work.copy=true
  expect_reference "$1" "$2, brick 128, shard 2" work.brick=128 work.shard=2 run.memory=64GiB
  expect_reference_after_kills "$1" "$2, kills" work.brick=32
}

# solid OP SHAPE CENTER MORE: an [[edit]] table.
solid() { printf '[[edit]]\nop = "%s"\nshape = "%s"\ncenter = %s\n%s\n' "$@"; }

step_labels() {
  local mode file=$data/label/frogtissue.mhd
  if [ ! -r "$file" ]; then
    report labels frogtissue skipped "needs $file"
    return
  fi
  for mode in each shared; do
    config=$scratch/frog-$mode.toml
    {
      printf '[input]\npath = "%s"\n[labels]\nmode = "%s"\n' "$file" $mode
      solid add sphere '[250, 230, 100]' $'radius = 40\nmaterial = 3'
      solid replace box '[240, 200, 110]' $'size = [80, 200, 60]\nmaterial = 99'
      solid subtract cylinder '[260, 240, 100]' $'radius = 15\nheight = 400\naxis = [1, 0, 0]'
    } >"$config"
    everything labels $mode
  done
}

step_edits() {
  {
    cat "$config"
    solid subtract sphere '[86, 86, 90]' 'radius = 30'
    solid add box '[60, 100, 60]' $'size = [40, 20, 30]\nrotate = [10, 20, 30]'
    solid intersect plane '[0, 0, 150]' 'axis = [0, 0, 1]'
  } >"$scratch/bunny-edits.toml"
  config=$scratch/bunny-edits.toml
  everything edits "the bunny CT"
}

step_mesh() {
  local file
  file=$(find "$data/meshes" -name 'rocker-arm*' 2>/dev/null | sort | head -n 1)
  if [ -z "$file" ]; then
    report mesh rocker-arm skipped "needs rocker-arm in $data/meshes"
    return
  fi
  config=$scratch/mesh.toml
  {
    printf '[input]\npath = "%s"\nresolution = 512\n' "$file"
    solid subtract sphere '[0, 0, 0.4]' 'radius = 0.12'
  } >"$config"
  everything mesh rocker-arm
}

step_tiles() {
  local vertices first='' hash
  for vertices in 500000 100000 20000 1024; do
    if ! run tiles output.tile_vertices=$vertices output.merged=true; then
      report tiles "tile_vertices $vertices" FAILED "$(tail -n 1 "$scratch/tiles.err")"
      continue
    fi
    hash=$(cat "$scratch"/tiles.mesh/mesh.* | sha256sum)
    first=${first:-$hash}
    if [ "$hash" = "$first" ]; then
      report tiles "tile_vertices $vertices" same "$(wc -l <"$scratch/tiles.mesh/tiles.jsonl") tiles"
    else
      report tiles "tile_vertices $vertices" FAILED "the merged mesh differs"
    fi
  done
  forget tiles
}

# phantom KIND SIZE: makes it, and its config.
phantom() {
  local file=$scratch/$1-$2.nrrd
  config=$scratch/$1-$2.toml
  [ -f "$file" ] || "$voxweld" phantom "$1" --size "$2" --type uint8 -o "$file" --log-level quiet \
    >/dev/null
  printf '[input]\npath = "%s"\n[surface]\nisovalue = 127.5\ninside = "below"\n' "$file" >"$config"
}
forget_phantom() { rm -f "$scratch/$1-$2.nrrd" "$scratch/$1-$2.toml"; }

step_phantoms() {
  local kind begin
  for kind in gyroid part porous temple; do
    phantom $kind 512
    begin=$(now)
    if ! run phantom; then
      report phantoms "$kind 512^3" FAILED "$(tail -n 1 "$scratch/phantom.err")"
    elif ! "$voxweld" verify "$scratch/phantom.mesh" >"$scratch/verify.out" 2>&1; then
      report phantoms "$kind 512^3" FAILED "verify: $(tail -n 1 "$scratch/verify.out")"
    else
      report phantoms "$kind 512^3" clean "$(since "$begin") s; $(head -n 1 "$scratch/verify.out")"
    fi
    forget phantom
    forget_phantom $kind 512
  done
}

# measured STEP KIND SIZE MEBIBYTES [SETTING...]: a run under that run.memory, its peak as the system has it.
measured() {
  local step=$1 kind=$2 size=$3 limit=$4 seconds peak case
  shift 4
  case="$kind $size^3, run.memory ${limit}MiB"
  if [ ! -x /usr/bin/time ]; then
    report "$step" "$case" skipped "needs /usr/bin/time"
    return
  fi
  phantom "$kind" "$size"
  arguments measured "run.memory=${limit}MiB" "$@"
  if ! /usr/bin/time -v -o "$scratch/time.txt" "$voxweld" "${args[@]}" \
    >/dev/null 2>"$scratch/measured.err"; then
    report "$step" "$case" FAILED "$(tail -n 1 "$scratch/measured.err")"
  else
    peak=$(($(awk '/Maximum resident/ { print $NF }' "$scratch/time.txt") / 1024))
    seconds=$(awk '/Elapsed/ { print $NF }' "$scratch/time.txt")
    if [ "$peak" -ge "$limit" ]; then
      report "$step" "$case" FAILED "peak $peak MiB"
    else
      report "$step" "$case" below "peak $peak MiB, $seconds"
    fi
  fi
  forget measured
  forget_phantom "$kind" "$size"
}

step_memory() {
  measured memory noise 512 512
  measured memory gyroid 1024 512
  measured memory part 1024 512
}

step_figures() {
  local kind
  # The default tile takes more than that to encode.
  for kind in gyroid part noise; do measured figures $kind 512 256 output.tile_vertices=200000; done
}

for step in "${steps[@]}"; do
  case $step in
    partition | kills | tiles | edits)
      if ! bunny; then
        report "$step" "bunny CT" skipped "$missing"
        continue
      fi
      ;;
  esac
  "step_$step"
done

printf '\n%-10s %-44s %-8s %s\n' step case result figures
printf '%s\n' "${rows[@]}"
[ "$failures" -eq 0 ] || {
  echo "$failures failed" >&2
  exit 1
}
