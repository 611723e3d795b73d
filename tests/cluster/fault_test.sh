#!/usr/bin/env bash
# Runs on the test cluster while things break or change: whatever happens, a run that ends well has
# left the bytes of a local run of its config on an input that was there meanwhile. Starts a cluster
# of three nodes, injects faults into runs at random moments, and runs the same command again where
# one has failed with a message or something has changed under it, until one ends well of what is
# there. Ends on a table: faults, runs, those that never failed, that needed another try, that were
# lost (there shall be none).
# Exits 77 (skipped) where a cluster cannot be made.
# Usage: tests/cluster/fault_test.sh [KIND...]        (default: all but hold and mixed)
#   kill        a task's process is killed (-9)
#   crash       a node dies and comes back some seconds later
#   partition   a node loses its network and gets it back, sometimes after Slurm has given it up
#   controller  slurmctld is killed and starts again on the state that it had saved
#   driver      voxweld run itself is killed and started again
#   disk        the disk of work and output directory is full for some seconds
#   memory      a run with too little memory for its tasks, then one with enough
#   input       the run's input is replaced, written over or touched, also with its time set back
#   config      the run's config changes, for the next start of the driver or with one at once; or
#               another run of the same or another config begins on the same work, here or in Slurm
#   hold        a task that waits is held in the queue, which the driver gives up after half a minute
#   mixed       any of kill, crash, partition, controller, driver, input, config
# Environment: VOXWELD (the program, default build/voxweld), VOXWELD_SEED (of what breaks when;
# default: chosen and said), VOXWELD_FAULTS (how many in all, default 18), VOXWELD_FAULTS_A_RUN (at
# most, default 3), VOXWELD_CLUSTER_DIR (default: a new folder, removed at the end), VOXWELD_KEEP
# (a folder: the logs of drivers go there).
set -euo pipefail
# shellcheck source=tests/cluster/support.sh
source "$(dirname "${BASH_SOURCE[0]}")/support.sh"
# shellcheck source=tests/cluster/faults.sh
source "$here/faults.sh"
# shellcheck source=tests/cluster/changes.sh
source "$here/changes.sh"
# shellcheck source=tests/cluster/fault_run.sh
source "$here/fault_run.sh"
voxweld=$(realpath "${VOXWELD:-$root/build/voxweld}")
faults=${VOXWELD_FAULTS:-18}
faults_a_run=${VOXWELD_FAULTS_A_RUN:-3}
seed=${VOXWELD_SEED:-$RANDOM}
nodes=3
run_limit=600 # seconds; a run that takes longer hangs
most_reruns=5
known=(kill crash partition controller driver disk memory input config hold mixed)
kinds=("$@")
[ $# -gt 0 ] || kinds=("${known[@]:0:9}")
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
started=no
cleanup() {
  local process
  for process in $driver $companion; do kill -9 "$process" 2>/dev/null || true; done
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
case " ${kinds[*]} " in
  *\ input\ * | *\ config\ * | *\ mixed\ *) make_references "$inputs" "${#configs[@]}" ;;
  *) make_references 1 1 ;;
esac

started=yes
variables=$(NODES=$nodes CPUS=2,1,2 MEMORY_MB=2000 "$cluster" start)
eval "$variables"
say "seed $seed, $faults faults of: ${kinds[*]}; cluster of $nodes nodes in $VOXWELD_CLUSTER_DIR"
RANDOM=$seed

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
