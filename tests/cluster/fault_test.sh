#!/usr/bin/env bash
# Runs on the test cluster while things break: whatever fails, the output is the bytes of a local
# run. Starts a cluster of three nodes, injects faults into runs at random moments, runs the same
# command again where a run has failed with a message, and ends on a table: faults, runs, those that
# survived at the first try, that needed another, that were lost (there shall be none).
# Exits 77 (skipped) where a cluster cannot be made.
# Usage: tests/cluster/fault_test.sh [KIND...]        (default: all but hold and mixed)
#   kill        a task's process is killed (-9)
#   crash       a node dies and comes back some seconds later
#   partition   a node loses its network and gets it back, sometimes after Slurm has given it up
#   controller  slurmctld is killed and starts again on the state that it had saved
#   driver      voxweld run itself is killed and started again
#   disk        the disk of work and output directory is full for some seconds
#   memory      a run with too little memory for its tasks, then one with enough
#   hold        a task that waits is held in the queue, which the driver gives up after half a minute
#   mixed       any of kill, crash, partition, controller, driver
# Environment: VOXWELD (the program, default build/voxweld), VOXWELD_SEED (of what breaks when;
# default: chosen and said), VOXWELD_FAULTS (how many in all, default 14), VOXWELD_FAULTS_A_RUN (at
# most, default 3), VOXWELD_CLUSTER_DIR (default: a new folder, removed at the end), VOXWELD_KEEP
# (a folder: the logs of drivers go there).
set -euo pipefail
# shellcheck source=tests/cluster/support.sh
source "$(dirname "${BASH_SOURCE[0]}")/support.sh"
# shellcheck source=tests/cluster/faults.sh
source "$here/faults.sh"
voxweld=$(realpath "${VOXWELD:-$root/build/voxweld}")
faults=${VOXWELD_FAULTS:-14}
faults_a_run=${VOXWELD_FAULTS_A_RUN:-3}
seed=${VOXWELD_SEED:-$RANDOM}
nodes=3
run_limit=600 # seconds; a run that takes longer hangs
reruns=5
known=(kill crash partition controller driver disk memory hold mixed)
kinds=("$@")
[ $# -gt 0 ] || kinds=("${known[@]:0:7}")
require_known kind "${known[*]}" "${kinds[@]}"
require_program "$voxweld" "build it, or name it in VOXWELD"
require_cluster

own_folder=no
if [ -z "${VOXWELD_CLUSTER_DIR:-}" ]; then
  VOXWELD_CLUSTER_DIR=$(mktemp -d "${TMPDIR:-/tmp}/vxwfault.XXXX")
  own_folder=yes
fi
export VOXWELD_CLUSTER_DIR
folder=$(realpath -m "$VOXWELD_CLUSTER_DIR")/faults
small=$folder/small # the disk that fills up
driver=
started=no
cleanup() {
  [ -z "$driver" ] || kill -9 "$driver" 2>/dev/null || true
  [ "$started" = no ] || "$cluster" stop
  ! mountpoint -q "$small" || umount -l "$small"
  rm -rf "$folder"
  [ "$own_folder" = no ] || rm -rf "$VOXWELD_CLUSTER_DIR"
}
trap cleanup EXIT
trap 'exit 130' INT TERM

say() { printf '%4d s  %s\n' "$SECONDS" "$*"; }

# Temporary files are counted by themselves.
mesh_hash() { tree_hash "$1" ! -name '*.tmp-*'; }

[ "$(mount | grep -c " $small ")" -eq 0 ] || umount -l "$small"
rm -rf "$folder"
mkdir -p "$small"
mount -t tmpfs -o size=128m,mode=1777 small "$small" || fail "cannot mount a small disk"
install_program "$folder"
cd "$folder"
"$voxweld" phantom porous --size 192 --type uint8 -o "$folder/porous.nrrd" >/dev/null
# The work is quick: each task's process is stopped most of its first two seconds, so that there is
# something to strike at. The merged mesh is what needs much memory.
cat >"$folder/porous.toml" <<'CONFIG'
[input]
path = "porous.nrrd"
[work]
brick = 32
shard = 2
copy = true
[surface]
isovalue = 127.5
inside = "below"
[output]
tile_vertices = 30000
merged = true
[run]
memory = "700MiB"
[slurm]
cpus_per_task = 1
shards_per_task = 2
prologue = ["p=$$; (for i in {1..9}; do kill -STOP $p; sleep 0.1; kill -CONT $p; sleep 0.01; done) 2>/dev/null &"]
CONFIG
"$voxweld" run "$folder/porous.toml" --log-level warning \
  --set "work.directory=$folder/local.work" --set "output.directory=$folder/local.mesh" >/dev/null
reference=$(mesh_hash "$folder/local.mesh")
rm -rf "$folder/local.work"

started=yes
variables=$(NODES=$nodes CPUS=2,1,2 MEMORY_MB=2000 "$cluster" start)
eval "$variables"
say "seed $seed, $faults faults of: ${kinds[*]}; cluster of $nodes nodes in $VOXWELD_CLUSTER_DIR"
RANDOM=$seed

# start_driver: the run `name` in the background, with `settings`; sets driver.
start_driver() {
  local arguments=() setting
  for setting in run.executor=slurm "work.directory=$place/work" "output.directory=$place/mesh" \
    "${settings[@]}"; do
    arguments+=(--set "$setting")
  done
  "$voxweld" run "$folder/porous.toml" "${arguments[@]}" >>"$log" 2>&1 &
  driver=$!
}

# tend_nodes: what an administrator does. Slurm drains a node that runs a task with the id of a new
# one, as it comes to be where slurmctld lost what it had not saved, or whose tasks do not end.
tended=0
tend_nodes() {
  local node
  [ "$SECONDS" -ge $((tended + 5)) ] || return 0
  tended=$SECONDS
  for node in $(timeout 10 sinfo -h -N -t drain,drained -o %N 2>/dev/null); do
    timeout 10 scontrol update "nodename=$node" state=resume 2>/dev/null || true
  done
}

# finish_driver: waits for it; sets status. 124 and killed where it hangs.
finish_driver() {
  local deadline=$((SECONDS + run_limit))
  while driver_lives; do
    if [ "$SECONDS" -ge "$deadline" ]; then
      squeue -r || true
      kill -9 "$driver"
      wait "$driver" 2>/dev/null || true
      driver='' status=124
      return
    fi
    tend_nodes
    sleep 0.1
  done
  status=0
  wait "$driver" || status=$?
  driver=
}

all_idle() { [ "$(timeout 10 sinfo -h -N -t idle -o %N 2>/dev/null | wc -l)" -eq "$nodes" ]; }
# What a run leaves in the queue must not meet the next.
calm_down() {
  local deadline=$((SECONDS + 90))
  left_tasks=$(timeout 20 squeue -h -r -t PD,R 2>/dev/null | wc -l || true)
  until all_idle && [ -z "$(timeout 10 squeue -h -t PD,R,CG 2>/dev/null)" ]; do
    timeout 20 scancel --user="$(id -un)" 2>/dev/null || true
    tend_nodes
    if [ "$SECONDS" -ge "$deadline" ]; then
      "$cluster" nodes
      scontrol show nodes | grep Reason || true
      fail "the cluster does not come to rest"
    fi
    sleep 0.5
  done
}

declare -A injected runs first again lost unclear left_files
# one_run KIND FAULTS: a run that is struck up to that often.
one_run() {
  local kind=$1 most=$2 struck=0 attempt=0 result=lost note=
  runs[$kind]=$((runs[$kind] + 1))
  name=$kind-${runs[$kind]}
  place=$folder/$name
  [ "$kind" != disk ] || place=$small/$name
  log=$folder/$name.log settings=()
  mkdir -p "$place"
  if [ "$kind" = memory ]; then
    starve
    struck=1
    say "$name: $what"
  fi
  start_driver
  [ "$kind" = memory ] || doze 0 9000 # any stage may be the first to be struck
  while [ "$kind" != memory ] && [ "$struck" -lt "$most" ] && driver_lives; do
    doze 300 4000
    driver_lives || break
    "inject_$kind" || continue
    struck=$((struck + 1))
    say "$name: $what"
  done
  injected[$kind]=$((injected[$kind] + struck))
  for (( ; ; )); do
    finish_driver
    [ "$status" -ne 0 ] || break
    if [ "$status" -gt 2 ]; then
      note=" (exit code $status)"
      break
    fi
    failure_text | cut -c 1-300 | head -n 8 | sed 's/^/          | /'
    is_clear "$kind" || unclear[$kind]=$((unclear[$kind] + 1))
    attempt=$((attempt + 1))
    [ "$attempt" -le "$reruns" ] || break
    settings=()
    start_driver
  done
  local files
  files=$(find "$place" -name '*.tmp-*' | wc -l)
  find "$place" -name '*.tmp-*' -printf '          | left: %P\n' | head -n 5
  left_files[$kind]=$((left_files[$kind] + files))
  if [ "$status" -eq 0 ]; then
    if [ "$(mesh_hash "$place/mesh")" != "$reference" ]; then
      note=" (other bytes than the local run)"
    elif ! "$voxweld" verify "$place/mesh" >"$folder/verify" 2>&1; then
      note=" (verify: $(tail -n 1 "$folder/verify"))"
    else
      result=survived
    fi
  fi
  calm_down
  case $result in
    lost) lost[$kind]=$((lost[$kind] + 1)) && tail -n 25 "$log" ;;
    *) if [ "$attempt" -eq 0 ]; then
      first[$kind]=$((first[$kind] + 1))
    else
      again[$kind]=$((again[$kind] + 1))
    fi ;;
  esac
  say "$name: $result$note, $struck faults, $attempt reruns, $files temporary files and" \
    "$left_tasks tasks left"
  if [ -n "${VOXWELD_KEEP:-}" ]; then
    mkdir -p "$VOXWELD_KEEP"
    cp "$log" "$VOXWELD_KEEP/$seed-$name.log"
  fi
  rm -rf "$place"
}

# The faults are dealt out to the kinds in turn.
for ((i = 0; i < ${#kinds[@]}; i++)); do
  kind=${kinds[i]}
  injected[$kind]=0 runs[$kind]=0 first[$kind]=0 again[$kind]=0
  lost[$kind]=0 unclear[$kind]=0 left_files[$kind]=0
  share=$((faults / ${#kinds[@]} + (i < faults % ${#kinds[@]} ? 1 : 0)))
  while [ "${injected[$kind]}" -lt "$share" ]; do
    [ "${runs[$kind]}" -lt $((share + 3)) ] || fail "$kind: runs end before anything strikes"
    open=$((share - injected[$kind]))
    one_run "$kind" $((open < faults_a_run ? open : faults_a_run))
  done
done

printf '\n%-11s %6s %5s %10s %6s %5s %8s %11s\n' kind faults runs 'first try' rerun lost unclear \
  'left files'
bad=0
for kind in "${kinds[@]}"; do
  printf '%-11s %6d %5d %10d %6d %5d %8d %11d\n' "$kind" "${injected[$kind]}" "${runs[$kind]}" \
    "${first[$kind]}" "${again[$kind]}" "${lost[$kind]}" "${unclear[$kind]}" "${left_files[$kind]}"
  bad=$((bad + lost[$kind] + unclear[$kind]))
done
[ "$bad" -eq 0 ] || fail "seed $seed: $bad runs were lost or failed without a clear message"
echo "seed $seed: no run lost"
