#!/usr/bin/env bash
# Runs of voxweld on the test cluster, whose nodes differ in processors: driven from here and handed
# over, both end in the bytes of a local run, refined or not; a cancelled one is taken up again, and
# so is one whose driver died at the worst moment; what cannot run is refused; an image that cannot be
# read stops no more than its layer. Prints a line a step with its seconds. Exits 77 (skipped) where a
# cluster cannot be made.
# Usage: tests/cluster/run_test.sh [VOXWELD]        (default: build/voxweld)
set -euo pipefail
# shellcheck source=tests/cluster/support.sh
source "$(dirname "${BASH_SOURCE[0]}")/support.sh"
voxweld=$(realpath "${1:-$root/build/voxweld}")
require_cluster
make_shared_folder vxwrun

# on NAME COMMAND [OPTION...]: of $config, into directories of that name.
config=scene
on() {
  local name=$1 command=$2
  shift 2
  timeout 300 "$voxweld" "$command" "$data/$config.toml" --set "work.directory=$data/$name.work" \
    --set "output.directory=$data/$name.mesh" "$@" >"$data/$name.$command.log" 2>&1
}
same() { # same NAME [HASH]: as the local run
  [ "$(tree_hash "$data/$1.mesh")" = "${2:-$expected}" ] || fail "$1: other bytes than the local run"
  "$voxweld" verify "$data/$1.mesh" >"$data/$1.verify.log" 2>&1 || fail "$1: verify finds faults"
}
wait_until_finished() { # wait_until_finished NAME [OPTION...]
  local deadline=$((SECONDS + 120))
  until on "$1" status "${@:2}"; do
    [ "$SECONDS" -lt "$deadline" ] || fail "$1: not finished: $(cat "$data/$1.status.log")"
    sleep 1
  done
}

install_program "$data"
cd "$data"
eval "$(CPUS=2,1,2 "$cluster" start)"
step "a cluster of three nodes"

"$voxweld" phantom porous --size 160 --type uint8 -o "$data/porous.nrrd" >/dev/null
cat >"$data/scene.toml" <<'END'
[input]
path = "porous.nrrd"
[work]
brick = 32
shard = 2
[surface]
isovalue = "otsu"
inside = "below"
[simplify]
refine = "off"
[output]
tile_vertices = 20000
[run]
memory = "1GiB"
[slurm]
cpus_per_task = 1
shards_per_task = 4
END
on local run || fail "the local run"
expected=$(tree_hash "$data/local.mesh")
step "a local run"

on driven run --set run.executor=slurm || fail "the driven run"
same driven
step "driven from here: the same bytes"

on driven run --set run.executor=slurm || fail "the second driven run"
! grep -q "job [0-9]* of" "$data/driven.run.log" || fail "a finished run submits tasks"
step "once more: nothing is submitted"

on handed submit || fail "submit"
! on handed submit || fail "submitted twice"
grep -q "in Slurm already" "$data/handed.submit.log" || fail "submitted twice: $(cat "$data/handed.submit.log")"
wait_until_finished handed
same handed
step "handed to Slurm: the same bytes"

# Five more stages.
on fine run --set simplify.refine=auto || fail "the refined local run"
refined=$(tree_hash "$data/fine.mesh")
on refined run --set simplify.refine=auto --set run.executor=slurm || fail "the refined run"
same refined "$refined"
for stage in refine seams mend remend retile; do
  grep -q "$stage: job [0-9]* of" "$data/refined.run.log" || fail "no task did $stage"
done
step "refined: the same bytes"

# A level after the other.
levels=(--set simplify.refine=auto --set output.levels=auto --set output.tile_vertices=2000)
on leveled run "${levels[@]}" || fail "the local run with levels"
coarse=$(tree_hash "$data/leveled.mesh")
on levels run "${levels[@]}" --set run.executor=slurm || fail "the run with levels"
same levels "$coarse"
[ "$(grep -c "levels: job [0-9]* of" "$data/levels.run.log")" -gt 1 ] || fail "tasks did not do several levels"
on stacked submit "${levels[@]}" || fail "submit with levels"
wait_until_finished stacked "${levels[@]}"
same stacked "$coarse"
step "levels of detail: the same bytes"

on broken submit || fail "submit"
sleep 2
on broken cancel || fail "cancel"
sleep 1
[ -z "$(timeout 10 squeue -h)" ] || fail "cancelled jobs are in the queue"
on broken run --set run.executor=slurm || fail "the run after the cancelled one"
same broken
"$voxweld" logs "$data/scene.toml" 0 --set "work.directory=$data/broken.work" >"$data/logs.log" 2>&1 ||
  fail "logs"
grep -q "task 0 on node" "$data/logs.log" || fail "logs does not show who had shard 0"
step "cancelled and taken up again: the same bytes"

# Every node with the vector instructions of another processor, where this one has them.
kernels='case $SLURMD_NODENAME in *1) export VOXWELD_KERNELS=base;; *2) ! grep -qw avx2 /proc/cpuinfo || export VOXWELD_KERNELS=avx2;; esac'
on mixed run --set run.executor=slurm \
  --set "slurm.prologue=[\"$kernels\"]" || fail "nodes of different processors"
same mixed
for artifact in $(find "$data/mixed.work" -name '*.octree'); do
  "$voxweld" info --json "$artifact" | grep -o '"kernels": *"[a-z0-9]*"'
done | sort | uniq -c >"$data/kernels.log"
[ "$(wc -l <"$data/kernels.log")" -gt 1 ] || fail "all octrees are of one kind of processor: $(cat "$data/kernels.log")"
step "nodes of different processors: the same bytes"

# The driver dies when Slurm has taken its first array and nobody knows the id.
mkdir "$data/early"
cat >"$data/early/sbatch" <<END
#!/bin/bash
"$(command -v sbatch)" "\$@" || exit
[[ \$* = *--version* ]] || kill -9 \$PPID
END
chmod +x "$data/early/sbatch"
! (PATH=$data/early:$PATH on orphan run --set run.executor=slurm \
  --set 'slurm.prologue=["sleep 3"]') 2>/dev/null || fail "the driver did not die"
[ -z "$(find "$data/orphan.work/slurm" -name job)" ] || fail "the id was written"
! on orphan status || fail "finished without a driver"
grep -q "^job [0-9]* (ingest" "$data/orphan.status.log" ||
  fail "status does not know the array: $(cat "$data/orphan.status.log")"
on orphan run --set run.executor=slurm || fail "the run after it"
grep -q "ingest: [0-9]* tasks are in Slurm already" "$data/orphan.run.log" ||
  fail "it was not taken over: $(cat "$data/orphan.run.log")"
! grep -q "ingest: job" "$data/orphan.run.log" || fail "it was submitted twice"
same orphan
step "a driver that died before it knew its job's id: taken over"

! on greedy run --set run.executor=slurm --set slurm.cpus_per_task=64 || fail "64 processors"
grep -q "slurm.cpus_per_task" "$data/greedy.run.log" || fail "$(cat "$data/greedy.run.log")"
[ -z "$(timeout 10 squeue -h)" ] || fail "what never starts is in the queue"
step "a task that no node has room for is refused"

# The same volume as images, one of which is cut short.
mkdir "$data/slices"
tail -c $((160 * 160 * 160)) "$data/porous.nrrd" >"$data/body.raw"
for z in $(seq 0 159); do
  {
    printf 'P5\n160 160\n255\n'
    dd if="$data/body.raw" bs=25600 skip="$z" count=1 status=none
  } >"$data/slices/slice_$z.pgm"
done
cp "$data/slices/slice_150.pgm" "$data/whole.pgm"
# What is chosen by all samples, as the isovalue above and the noise, would have to wait for them.
of_slices=(--set "input.path=$data/slices" --set surface.isovalue=127 --set surface.gradient=central)
truncate -s 20000 "$data/slices/slice_150.pgm"
! on slices run --set run.executor=slurm "${of_slices[@]}" ||
  fail "an image that cannot be read goes unnoticed"
grep -q "slice_150.pgm" "$data/slices.run.log" || fail "the bad image is not named"
grep -q "9 of 27 shards of the input cannot be read" "$data/slices.run.log" ||
  fail "more than the image's layer is missing: $(cat "$data/slices.run.log")"
cp "$data/whole.pgm" "$data/slices/slice_150.pgm"
on slices run --set run.executor=slurm "${of_slices[@]}" ||
  fail "the run with the image mended"
grep -qE "^ingest +9 shards" "$data/slices.run.log" || fail "not only the layer was done again"
"$voxweld" verify "$data/slices.mesh" >"$data/slices.verify.log" 2>&1 || fail "verify"
step "an image that cannot be read: its layer is missing, and done when it is mended"

# Slices are ingested before they are filtered, and keep looks at the whole volume first.
sed "s|porous.nrrd|slices|" "$data/scene.toml" - >"$data/filtered.toml" <<'END'
[[filter]]
type = "median"
[[filter]]
type = "keep"
[[filter]]
type = "gaussian"
sigma = 0.7
END
config=filtered
on filtered_local run || fail "the local run with filters"
expected=$(tree_hash "$data/filtered_local.mesh")
on filtered run --set run.executor=slurm || fail "the driven run with filters"
same filtered
on filtered_handed submit || fail "submit with filters"
wait_until_finished filtered_handed
same filtered_handed
step "filters, driven from here and handed over: the same bytes"
ok=yes
