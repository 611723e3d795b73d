#!/usr/bin/env bash
# A real Slurm cluster on one machine, to test against: one munged, one slurmctld, a slurmd for each
# node. A node is a set of Linux namespaces (processes, mounts, host name, IPC, network) with its
# own /tmp and /dev/shm; everything else of the file system is shared by all nodes as it is. Needs
# root and tests/cluster/install_packages.sh.
#
# Usage: cluster.sh COMMAND
#   supported           exit 0 where such nodes can be made; else 1 and a line saying what is missing
#   start               starts it and waits until all nodes are idle; prints what the caller is to
#                       evaluate: eval "$(cluster.sh start)"
#   stop                ends and removes everything; logs stay until the next start
#   nodes               a line each: NAME STATE CPUS CPUS_IN_USE MEMORY_MB up|cut|down
#   exec K COMMAND...   runs COMMAND on node K, in the same folder as here
#   beside COMMAND...   runs COMMAND on this machine, held to QUOTA as a node's processes are
#   crash K, revive K   node K dies with all its processes, at once and silently; comes back
#   cut K, heal K       node K loses its network and runs on; gets it back
#   kill-controller     slurmctld is killed (-9) and forgets the last seconds, which it did
#                       not save: a task that began then begins again, with the same ids
#   start-controller    slurmctld starts on the state that it saved
#   restart-controller  both
#
# Environment
#   VOXWELD_CLUSTER_DIR folder of the cluster, the same for every command; clusters in different
#                       folders do not meet (default: voxweld-cluster below TMPDIR or /tmp). Also
#                       below /tmp every node sees it: what jobs share may lie in its subfolders.
# and, for start:
#   NODES               nodes (3)
#   CPUS                CPUs of a node, or a list for each of them: 2 or 4,2,2 (2; 1 with a QUOTA)
#   MEMORY_MB           memory of a node (4000)
#   PIN                 1: a node's processes keep to as many real cores, dealt out in turn (0)
#   QUOTA               what all processes of a node get together, in percent of a real core: 40 makes
#                       three nodes of equal speed on two cores (none: what there is). Needs the cpu
#                       controller of cgroups, version 1 or 2.
#   MIN_JOB_AGE         seconds that Slurm remembers an ended job (300)
set -euo pipefail

here=$(dirname "${BASH_SOURCE[0]}")
# shellcheck source=tests/cluster/machine.sh
source "$here/machine.sh"
# shellcheck source=tests/cluster/slurm.sh
source "$here/slurm.sh"

usage() { sed -n '/^# A real/,/^set -/s/^# \{0,1\}//p' "$0"; }

# Reads and checks what `start` is given.
read_settings() {
  nodes=${NODES:-3} memory_mb=${MEMORY_MB:-4000} pin=${PIN:-0} min_job_age=${MIN_JOB_AGE:-300}
  quota=${QUOTA:-}
  local name value default_cpus=2
  for name in NODES MEMORY_MB MIN_JOB_AGE; do
    value=${!name:-1}
    [[ $value =~ ^[1-9][0-9]{0,8}$ ]] || fail "$name is not a positive number: $value"
  done
  [ "$nodes" -le "$max_nodes" ] || fail "NODES is $nodes, more than $max_nodes"
  [[ $pin =~ ^[01]$ ]] || fail "PIN is neither 0 nor 1: $pin"
  if [ -n "$quota" ]; then
    default_cpus=1
    [[ $quota =~ ^[1-9][0-9]{0,4}$ && $quota -ge $least_quota ]] ||
      fail "QUOTA is not a number of percent from $least_quota to 99999: $quota"
  fi
  [[ ${CPUS:=$default_cpus} =~ ^[1-9][0-9]{0,3}(,[1-9][0-9]{0,3})*$ ]] || fail "CPUS is not a number or a list: $CPUS"
  IFS=, read -ra cpus <<<"$CPUS"
  if [ ${#cpus[@]} -eq 1 ]; then
    local node
    for ((node = 1; node < nodes; node++)); do cpus+=("${cpus[0]}"); done
  fi
  [ ${#cpus[@]} -eq "$nodes" ] || fail "CPUS names ${#cpus[@]} nodes of $nodes: $CPUS"
}

# What is left of an unsuccessful start is of interest only in its logs.
give_up() {
  trap - EXIT
  tail -n 5 "$logs"/* >&2 2>/dev/null || true
  remove_machines
  remove_groups
  rm -rf "$run"
  echo "cluster: did not start; logs: $logs" >&2
}

start() {
  read_settings
  why_unsupported
  local program
  for program in munged slurmctld slurmd sinfo scontrol; do
    command -v "$program" >/dev/null ||
      fail "$program is not installed; run tests/cluster/install_packages.sh"
  done
  refuse_if_taken
  rm -rf "$run" "$logs"
  mkdir -p "$run" "$logs"
  trap give_up EXIT
  [ -z "$quota" ] || make_group beside "$quota"
  make_head
  write_configuration
  start_munged
  start_controller
  local node
  for ((node = 1; node <= nodes; node++)); do
    make_machine "$node"
    [ -z "$quota" ] || make_group "$node" "$quota"
    boot "$node"
  done
  wait_for "$((60 + 5 * nodes))" "all nodes to be idle" all_nodes_idle
  trap - EXIT
}

stop() {
  may_remove_link || fail "network interface $tag belongs to $(link_owner), not to $dir"
  remove_machines
  remove_groups
  rm -rf "$run"
}

# show_nodes: what Slurm says of each node beside what is the case.
show_nodes() {
  local said node state
  said=$(ask sinfo -h -N -o '%N %t %C %m' || true)
  for node in $(machines); do
    state=$(awk -v name="node$node" '$1 == name { split($3, c, "/"); print $2, c[4], c[1], $4 }' <<<"$said")
    echo "node$node ${state:-unknown - - -} $(machine_state "$node")"
  done
}

command=${1:-}
shift || true
case $command in
  -h | --help) usage && exit 0 ;;
  supported) why_unsupported && exit 0 ;;
  start | stop | nodes | kill-controller | start-controller | restart-controller) arguments=0 ;;
  crash | revive | cut | heal) arguments=1 ;;
  beside) arguments=1 ;;
  exec) arguments=2 ;;
  *) usage >&2 && exit 2 ;;
esac
if [ $# -lt "$arguments" ] ||
  { [ $# -gt "$arguments" ] && [ "$command" != exec ] && [ "$command" != beside ]; }; then
  fail "$command: wrong number of arguments; see cluster.sh -h"
fi
[ "$(id -u)" -eq 0 ] || fail "needs root"
choose_folder
case $command in start | stop) ;; *)
  owns_link || fail "no cluster runs in $dir"
  [ "$arguments" -eq 0 ] || [ "$command" = beside ] || is_machine "$1" || fail "no such node: $1"
  ;;
esac

case $command in
  start) start >&2 && printf 'export SLURM_CONF=%q\n' "$SLURM_CONF" ;;
  stop) stop ;;
  nodes) show_nodes ;;
  exec) run_on "$@" ;;
  beside) enter_group beside && exec "$@" ;;
  crash) crash "$1" ;;
  revive) boot "$1" ;;
  cut) cut_link "$1" ;;
  heal) heal_link "$1" ;;
  kill-controller) kill_controller ;;
  start-controller) start_controller ;;
  restart-controller) kill_controller && start_controller ;;
esac
