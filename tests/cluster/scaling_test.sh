#!/usr/bin/env bash
# How a run on Slurm scales with nodes, and what of their time scheduling loses: the same phantom on
# clusters of 1, 2 and 3 nodes that are held to the same share of a core, as is the driver. Holds the
# output to the bytes of a local run and ends on two Markdown tables: a row a run, and a row a stage.
# Nothing else may run on the machine meanwhile; how busy it is otherwise is said before each run.
# Exits 77 (skipped) where a cluster of such nodes cannot be made.
# Usage: tests/cluster/scaling_test.sh [NODES...]        (default: 1 2 3; speed-up is against the first)
# Environment: VOXWELD (the program, default build/voxweld), VOXWELD_PHANTOM (default gyroid),
# VOXWELD_SIZE (its samples a side, default 1024), VOXWELD_QUOTA (percent of a core that a node gets;
# default: what lets nodes and driver fit beside Slurm's controller, at most 40), VOXWELD_SET (further
# settings, as slurm.shards_per_task=4, blanks between them), VOXWELD_LIMIT (seconds a run may take,
# default 7200), VOXWELD_CLUSTER_DIR (default: a new folder, removed at the end), VOXWELD_KEEP (a
# folder: drivers' logs with the time of each line and the figures of each task go there).
#
# A slot is what one task has at a time, here a node. Of a stage's slot time (slots x wall) tasks have
# what their reports say (work); the rest is lost, in this order:
#   plan    the stage begins -> the first array's script is written: what is left to do, into tasks
#   queue   a slot is free -> Slurm begins the task's log: sbatch, scheduling, launch, the end of a job
#   start   the task's log begins -> its own clock runs: shell, prologue, program, config
#   idle    a slot's last task ends -> the stage's last task ends
#   look    the last task ends -> the driver has seen it
# and between stages, with the driver's begin and end, all slots wait.
set -euo pipefail
# shellcheck source=tests/cluster/support.sh
source "$(dirname "${BASH_SOURCE[0]}")/support.sh"
voxweld=$(realpath "${VOXWELD:-$root/build/voxweld}")
phantom=${VOXWELD_PHANTOM:-gyroid}
size=${VOXWELD_SIZE:-1024}
limit=${VOXWELD_LIMIT:-7200}
keep=${VOXWELD_KEEP:+$(realpath -m "$VOXWELD_KEEP")}
counts=("$@")
[ $# -gt 0 ] || counts=(1 2 3)
most=0
for count in "${counts[@]}"; do
  [[ $count =~ ^[1-9][0-9]?$ ]] || {
    echo "not a number of nodes: $count" >&2
    exit 2
  }
  [ "$count" -le "$most" ] || most=$count
done
# Nodes and driver, and the controller with half of what one of them gets.
fits=$((200 * $(nproc) / (2 * most + 3)))
quota=${VOXWELD_QUOTA:-$((fits < 40 ? fits : 40))}
[[ $quota =~ ^[0-9]+$ && $quota -le $fits ]] || {
  echo "$most nodes and a driver of $quota % do not fit on $(nproc) cores; $fits % do" >&2
  exit 2
}
require_program "$voxweld" "build it, or name it in VOXWELD"
QUOTA=$quota require_cluster

own_folder=no
if [ -z "${VOXWELD_CLUSTER_DIR:-}" ]; then
  VOXWELD_CLUSTER_DIR=$(mktemp -d /var/tmp/vxwscale.XXXX)
  own_folder=yes
fi
export VOXWELD_CLUSTER_DIR
folder=$(realpath -m "$VOXWELD_CLUSTER_DIR")/scaling # seen by every node
started=no
cleanup() {
  [ "$started" = no ] || "$cluster" stop
  rm -rf "$folder"
  [ "$own_folder" = no ] || rm -rf "$VOXWELD_CLUSTER_DIR"
}
trap cleanup EXIT
trap 'exit 130' INT TERM

# Percent of all cores that were at work in the last two seconds.
busy_percent() {
  local before after
  before=$(head -n 1 /proc/stat)
  sleep 2
  after=$(head -n 1 /proc/stat)
  printf '%s\n' "$before" "$after" | awk '{
    all = 0
    for (i = 2; i <= 9; i++) all += $i
    idle = $5 + $6
    if (NR == 2) printf "%.0f", 100 * (1 - (idle - idle_before) / (all - all_before))
    idle_before = idle
    all_before = all
  }'
}

stamp() { # each line with its time
  local line
  while IFS= read -r line; do printf '%s %s\n' "$EPOCHREALTIME" "$line"; done
}

# stage_times LOG: a line a stage: S STAGE BEGIN END, by the driver's lines "STAGE: N units" and
# "STAGE   N units  T s".
stage_times() {
  awk '
    $2 ~ /^(ingest|build|merge|stitch|encode):$/ && $3 ~ /^[0-9]/ {
      stage = substr($2, 1, length($2) - 1)
      if (!(stage in begin)) begin[stage] = $1
    }
    $2 in begin { printf "S %s %s %s\n", $2, begin[$2], $1 }' "$1"
}

# task_times WORK_DIRECTORY: a line a task: T STAGE NODE SUBMIT LAUNCH BEGIN END CPU, by their begin.
# Its clock stops right before the report is written; the log's birth is when slurmd launches it.
task_times() {
  local report array task stage log
  for report in "$1"/slurm/*/array-*/reports/*.json; do
    array=$(dirname "$(dirname "$report")")
    task=$(basename "$report" .json)
    stage=$(basename "$(dirname "$array")")
    log=$(compgen -G "$array/logs/*_$task.log")
    printf 'T %s %s %s %s %s %s\n' "${stage%%-*}" \
      "$(sed -n 's/^ *"node": *"\(.*\)".*/\1/p' "$report")" \
      "$(stat -c %.6Y "$array/job.sh")" "$(stat -c %.6W "$log")" "$(stat -c %.6Y "$report")" \
      "$(sed -n 's/^ *"\(cpu_\)\{0,1\}seconds": *\([0-9.e+-]*\).*/\2/p' "$report" | paste -sd ' ')"
  done | awk '{
    begin = $6 - $8
    launch = ($5 < $4 || $5 > begin) ? begin : $5 # a file system without times of birth says 0
    printf "T %s %s %s %.6f %.6f %s %s\n", $2, $3, $4, launch, begin, $6, $7
  }' | sort -k 6,6n
}

# slot_times SLOTS: of such lines, a line a stage:
# STAGE TASKS WALL WORK PLAN QUEUE START IDLE LOOK CPU, all but WALL summed over slots, in seconds.
slot_times() {
  awk -v slots="$1" '
    $1 == "S" { order[++stages] = $2; begin[$2] = $3; end[$2] = $4 }
    $1 == "T" {
      slot = $2 " " $3
      # Times of files come from a clock of ticks, some ms behind.
      if (!($2 in submit)) submit[$2] = ($4 < begin[$2] ? begin[$2] : $4)
      if (!(slot in free)) { free[slot] = submit[$2]; used[$2]++ }
      tasks[$2]++
      queue[$2] += $5 - free[slot]
      start[$2] += $6 - $5
      work[$2] += $7 - $6
      cpu[$2] += $8
      free[slot] = $7
      if ($7 > last[$2]) last[$2] = $7
    }
    END {
      for (slot in free) {
        split(slot, name, " ")
        idle[name[1]] += last[name[1]] - free[slot]
      }
      for (i = 1; i <= stages; i++) {
        s = order[i]
        idle[s] += (slots - used[s]) * (last[s] - submit[s])
        printf "%s %d %.3f %.3f %.3f %.3f %.3f %.3f %.3f %.3f\n", s, tasks[s], end[s] - begin[s],
          work[s], slots * (submit[s] - begin[s]), queue[s], start[s], idle[s],
          slots * (end[s] - last[s]), cpu[s]
      }
    }'
}

rm -rf "$folder"
install_program "$folder"
cd "$folder"
"$voxweld" phantom "$phantom" --size "$size" --type uint8 -o "$folder/phantom.raw" 2>phantom.log |
  grep -o 'surface.*' | tr , '\n' >suggested || fail "$(cat phantom.log)"
{
  sed 's/^ *//' suggested
  printf '[input]\npath = "phantom.raw"\nsize = [%d, %d, %d]\ntype = "uint8"\n' "$size" "$size" "$size"
  printf '[run]\nmemory = "1GiB"\n[slurm]\ncpus_per_task = 1\n'
} >scan.toml
settings=()
for setting in ${VOXWELD_SET:-}; do settings+=(--set "$setting"); done
"$voxweld" run scan.toml --set work.directory=local.work --set output.directory=local.mesh \
  "${settings[@]}" >local.log 2>&1 || fail "the local run: $(tail -n 5 local.log)"
expected=$(tree_hash local.mesh)
rm -rf local.work local.mesh
step "$phantom of $size^3: a local run, for its bytes"

# measure NODES: a run on so many; its lines go to `figures`.
measure() {
  local name=nodes-$1 variables busy begin wall
  started=yes
  variables=$(NODES=$1 CPUS=1 QUOTA=$quota MEMORY_MB=2000 MIN_JOB_AGE=100000 "$cluster" start 2>start.log) ||
    fail "the cluster: $(cat start.log)"
  eval "$variables"
  busy=$(busy_percent)
  step "a cluster, nodes: $1; the machine is $busy % busy with other things"
  begin=$EPOCHREALTIME
  timeout "$limit" "$cluster" beside "$voxweld" run scan.toml --set run.executor=slurm \
    --set "work.directory=$name.work" --set "output.directory=$name.mesh" "${settings[@]}" 2>&1 |
    stamp >"$name.log" || fail "$name: $(tail -n 5 "$name.log")"
  wall=$(awk -v a="$begin" -v b="$EPOCHREALTIME" 'BEGIN { printf "%.3f", b - a }')
  [ "$(tree_hash "$name.mesh")" = "$expected" ] || fail "$name: other bytes than the local run"
  {
    stage_times "$name.log"
    task_times "$name.work"
  } >"$name.times"
  echo "$1 run $wall" >>figures
  slot_times "$1" <"$name.times" | sed "s/^/$1 /" >>figures
  if [ -n "$keep" ]; then
    mkdir -p "$keep"
    cp "$name.log" "$name.times" figures "$keep"
  fi
  "$cluster" stop
  started=no
  rm -rf "$name.work" "$name.mesh"
  step "a run of $wall s, nodes: $1; the bytes of the local run"
}
for count in "${counts[@]}"; do measure "$count"; done

printf '\n%s of %d^3 uint8, nodes and driver of %d %% of a core each\n\n' "$phantom" "$size" "$quota"
awk '
  function percent(part, whole) { return whole > 0 ? sprintf("%.1f", 100 * part / whole) : "-" }
  $2 == "run" { runs[++count] = $1; wall[$1] = $3; next }
  {
    if (!($2 in known)) { known[$2] = 1; order[++stages] = $2 }
    for (i = 3; i <= NF; i++) { cell[$1, $2, i] = $i; cell[$1, "all stages", i] += $i }
  }
  function row(nodes, stage, name,    i, whole) {
    whole = nodes * cell[nodes, stage, 4]
    printf "| %d | %s | %d | %.1f | %.2f | %.1f | %.1f | %s |", nodes, name, cell[nodes, stage, 3],
      cell[nodes, stage, 4], cell[runs[1], stage, 4] / cell[nodes, stage, 4],
      cell[nodes, stage, 5] / nodes, cell[nodes, stage, 11], percent(whole - cell[nodes, stage, 5], whole)
    for (i = 6; i <= 10; i++) printf " %s |", percent(cell[nodes, stage, i], whole)
    print ""
  }
  END {
    print "| nodes | wall s | speed-up | of the ideal % | between stages s | work s | lost % |"
    print "|---|---|---|---|---|---|---|"
    for (r = 1; r <= count; r++) {
      n = runs[r]
      speedup = wall[runs[1]] / wall[n]
      printf "| %d | %.1f | %.2f | %s | %.1f | %.1f | %s |\n", n, wall[n], speedup,
        percent(speedup * runs[1], n), wall[n] - cell[n, "all stages", 4], cell[n, "all stages", 5],
        percent(n * wall[n] - cell[n, "all stages", 5], n * wall[n])
    }
    print "\n| nodes | stage | tasks | wall s | speed-up | busy s | cpu s | lost % |" \
      " plan % | queue % | start % | idle % | look % |"
    print "|---|---|---|---|---|---|---|---|---|---|---|---|---|"
    for (r = 1; r <= count; r++) {
      for (s = 1; s <= stages; s++) row(runs[r], order[s], order[s])
      row(runs[r], "all stages", "all")
    }
  }' figures
printf '\n%s\n' "work: the tasks' own wall time, of all nodes; busy: by nodes; lost: of nodes x wall."
