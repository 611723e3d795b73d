#!/usr/bin/env bash
# Holds the test cluster to what it is for: array jobs run on all nodes; tasks of a node that
# crashes run elsewhere; a node that loses its network, and a controller that is killed, lose no
# task; too much memory ends a task; nothing is left afterwards. Prints a line a step with its
# seconds. Exits 77 (skipped) where a cluster cannot be made.
# Usage: tests/cluster/smoke_test.sh
set -euo pipefail
# shellcheck source=tests/cluster/support.sh
source "$(dirname "${BASH_SOURCE[0]}")/support.sh"
require_cluster

folder=$(mktemp -d "${TMPDIR:-/tmp}/vxwsmoke.XXXX")
export VOXWELD_CLUSTER_DIR=$folder
ok=no
cleanup() {
  if [ "$ok" = no ]; then
    "$cluster" nodes || true
    squeue || true
    tail -n 20 "$folder"/log/slurmctld.log || true
  fi >&2
  "$cluster" stop
  rm -rf "$folder"
}
trap cleanup EXIT

wait_for() { # wait_for SECONDS WHAT TEST...
  local deadline=$((SECONDS + $1)) what=$2
  shift 2
  until "$@"; do
    [ "$SECONDS" -lt "$deadline" ] || fail "waited in vain until $what"
    sleep 0.2
  done
}

# A task notes its beginning and its end in a file for each attempt: TASK.ATTEMPT.NODE.
cat >"$folder/task.sh" <<'TASK'
#!/bin/bash
note=$1/$SLURM_ARRAY_TASK_ID.${SLURM_RESTART_COUNT:-0}.$(hostname)
echo "begun: job $SLURM_JOB_ID of array $SLURM_ARRAY_JOB_ID on $SLURMD_NODENAME" >"$note"
sleep "$2"
echo "ended" >>"$note"
TASK

submit() { # submit NAME TASKS SECONDS: sets job and notes
  notes=$folder/$1
  mkdir "$notes"
  job=$(sbatch --parsable --array="0-$(($2 - 1))" --mem=100 --output="$notes/output" \
    "$folder/task.sh" "$notes" "$3")
}
ended() { grep -ls '^ended' "$notes"/[0-9]* | sed 's|.*/\([0-9]*\)\..*|\1|' | sort -nu; }
all_ended() { [ "$(ended | wc -l)" -eq "$1" ]; }
queue_empty() { local left && left=$(squeue -h -j "$job" -t PD,R,CG 2>/dev/null) && [ -z "$left" ]; }
attempts() { find "$notes" -name "$1" | wc -l; }
begun_on() { compgen -G "$notes/[0-9]*.node$1" >/dev/null; }
state_is() { grep -q "^node$1 $2" <<<"$("$cluster" nodes)"; }
finish() { # finish TASKS: waits for all tasks, and until Slurm knows
  wait_for 90 "all $1 tasks ended" all_ended "$1"
  wait_for 60 "the queue is empty" queue_empty
}

variables=$(NODES=3 CPUS=2 MEMORY_MB=2000 "$cluster" start)
eval "$variables"
step "start: 3 nodes idle"

# shellcheck disable=SC2016 # the node's shell expands it
"$cluster" exec 2 sh -c 'touch /tmp/mine && [ "$(hostname)" = node2 ]' || fail "exec on node 2"
! "$cluster" exec 1 test -e /tmp/mine || fail "/tmp of node 2 is that of node 1"
[ ! -e /tmp/mine ] || fail "/tmp of node 2 is the machine's"
"$cluster" exec 1 test -d "$folder" || fail "the cluster's folder is not shared"
if VOXWELD_CLUSTER_DIR=$folder "$cluster" start 2>/dev/null; then fail "a second start went through"; fi
step "exec: a node has its name and its own /tmp"

submit array 12 1
finish 12
for node in 1 2 3; do begun_on "$node" || fail "node $node ran no task"; done
[ "$(grep -l "array $job on" "$notes"/[0-9]* | wc -l)" -eq 12 ] || fail "not one attempt a task"
step "array: 12 tasks on 3 nodes, each once"

# shellcheck disable=SC2016 # variables of the job
job=$(sbatch --parsable --mem=100 --output="$folder/memory" --wrap \
  'perl -e "\$x = q(a) x 300000000; sleep 20"; true')
wait_for 60 "the task over its memory is gone" queue_empty
scontrol show job "$job" | grep -q 'JobState=FAILED\|JobState=OUT_OF_MEMORY' || fail "not killed"
step "memory: a task with 300 MB of its 100 was killed"

submit crash 10 3
wait_for 60 "node 2 runs a task" begun_on 2
"$cluster" crash 2
! grep -qs '^ended' "$notes"/[0-9]*.node2 || fail "crashed too late"
finish 10
for note in "$notes"/*.node2; do
  task=${note##*/} && task=${task%%.*}
  grep -qs '^ended' "$notes/$task."*.node[13] || fail "task $task of node 2 ran nowhere else"
done
step "crash: 10 tasks, $(attempts '*.node2') of node 2 ran elsewhere"
state_is 2 'down' || fail "Slurm does not know that node 2 is down"
"$cluster" revive 2
wait_for 60 "node 2 is back" state_is 2 idle
step "revive: node 2 idle"

submit cut 10 3
wait_for 60 "node 3 runs a task" begun_on 3
"$cluster" cut 3
wait_for 60 "Slurm misses node 3" state_is 3 'down'
"$cluster" heal 3
finish 10
wait_for 60 "node 3 is back" state_is 3 idle
step "cut, heal: 10 tasks, $(attempts '*.1.*') of them a second time"

# What slurmctld has not saved when it dies is lost, and it saves every few seconds only.
submit controller 10 8
saved() { [ "$folder/run/state/job_state" -nt "$notes/last" ]; }
all_begun() { [ "$(attempts '[0-9]*')" -ge 6 ]; }
wait_for 60 "6 tasks run" all_begun
touch "$notes/last"
wait_for 60 "slurmctld saved them" saved
"$cluster" restart-controller
finish 10
step "restart-controller: 10 tasks in $(attempts '[0-9]*') attempts"

name=$(ip -o link show | grep -w "alias $folder" | sed 's/^[0-9]*: \([^@:]*\).*/\1/')
[ -e "/run/netns/$name-head" ] || fail "no network namespace $name-head before stop"
"$cluster" stop
"$cluster" stop
left=$(ip -o link show | grep -w "$name" || true)
left+=$(compgen -G "/run/netns/$name-*" || true)
left+=$(grep -lzs "SLURM_CONF=$folder" /proc/[0-9]*/environ || true)
left+=$(grep "$folder" /proc/mounts || true)
[ -z "$left" ] || fail "left: $left"
step "stop: nothing left"
ok=yes
