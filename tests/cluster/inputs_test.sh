#!/usr/bin/env bash
# Labels of both modes, edits and a mesh as the input on the test cluster: each ends in the bytes of
# a local run, also when an edit changes in between and a node dies under way. Prints a line a step
# with its seconds. Exits 77 (skipped) where a cluster cannot be made.
# Usage: tests/cluster/inputs_test.sh [VOXWELD]        (default: build/voxweld)
set -euo pipefail
# shellcheck source=tests/cluster/support.sh
source "$(dirname "${BASH_SOURCE[0]}")/support.sh"
voxweld=$(realpath "${1:-$root/build/voxweld}")
require_cluster
make_shared_folder vxwinput

# on NAME SCENE COMMAND [OPTION...]: of the scene's config, into directories of that name.
on() {
  local name=$1 scene=$2 command=$3
  shift 3
  timeout 300 "$voxweld" "$command" "$data/$scene.toml" --set "work.directory=$data/$name.work" \
    --set "output.directory=$data/$name.mesh" "$@" >"$data/$name.$command.log" 2>&1
}
same() { # same NAME SCENE: as a local run from nothing
  rm -rf "$data/local.work" "$data/local.mesh"
  on local "$2" run || fail "$2: the local run"
  [ "$(tree_hash "$data/$1.mesh")" = "$(tree_hash "$data/local.mesh")" ] ||
    fail "$1: other bytes than the local run"
  "$voxweld" verify "$data/$1.mesh" >"$data/$1.verify.log" 2>&1 || fail "$1: verify finds faults"
}
config() { # config SCENE: with what is its own on standard input
  cat - "$data/common" >"$data/$1.toml"
}

install_program "$data"
cd "$data"
eval "$(CPUS=2 "$cluster" start)"
step "a cluster of three nodes"

cat >common <<'END'
[work]
brick = 16
shard = 2
[output]
tile_vertices = 20000
[run]
memory = "1GiB"
[slurm]
cpus_per_task = 1
shards_per_task = 3
END
"$voxweld" phantom labels --size 96 --type uint32 -o cells.nrrd >/dev/null
"$voxweld" phantom gyroid --size 96 --type uint8 -o gyroid.nrrd >/dev/null
"$voxweld" init gyroid.nrrd >/dev/null
"$voxweld" run gyroid.toml >/dev/null 2>&1
"$voxweld" export gyroid.mesh/mesh.drc -o part.stl >/dev/null
for mode in each shared; do
  config "$mode" <<END
[input]
path = "cells.nrrd"
[labels]
mode = "$mode"
min_voxels = 100
[[edit]]
op = "add"
shape = "sphere"
center = [40, 44, 50]
radius = 15.5
material = 7
END
done
config edited <<'END'
[input]
path = "gyroid.nrrd"
[surface]
isovalue = "otsu"
[[edit]]
op = "subtract"
shape = "sphere"
center = [20, 20, 20]
radius = 12
END
config mesh <<'END'
[input]
path = "part.stl"
resolution = 96
[[edit]]
op = "subtract"
shape = "mesh"
path = "part.stl"
center = [11, 5, 7]
END
# A slab of NaNs: bytes of all ones.
"$voxweld" phantom sphere --size 64 --type float32 -o holes.nrrd >/dev/null
size=$(stat -c %s holes.nrrd)
head -c 20000 /dev/zero | tr '\0' '\377' |
  dd of=holes.nrrd bs=1 seek=$((size - 64 * 64 * 4 * 34)) conv=notrunc status=none
config holes <<'END'
[input]
path = "holes.nrrd"
[surface]
isovalue = 0
END
step "the inputs"

for scene in each shared edited mesh holes; do
  on "$scene" "$scene" run --set run.executor=slurm || fail "$scene: the run on the cluster"
  same "$scene" "$scene"
  step "$scene: the same bytes as a local run"
done
[ "$(grep -c 'NaN' "$data/holes.run.log")" = 1 ] && grep -q '5000 samples are NaN' "$data/holes.run.log" ||
  fail "holes: the tasks' NaNs are not summed up"
step "holes: the tasks' NaNs are summed up"

# Another edit, and a node that dies while it is worked in.
for scene in each shared edited mesh; do
  cat >>"$data/$scene.toml" <<'END'
[[edit]]
op = "subtract"
shape = "sphere"
center = [70, 60, 50]
radius = 14
END
  on "$scene" "$scene" run --set run.executor=slurm --set 'slurm.prologue=["sleep 1"]' &
  run=$!
  sleep 2
  "$cluster" crash 2
  sleep 4
  "$cluster" revive 2
  wait "$run" || fail "$scene: the run with a new edit"
  same "$scene" "$scene"
  step "$scene: with a new edit, and a node that died"
done
ok=yes
