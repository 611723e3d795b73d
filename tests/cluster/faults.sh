# The faults of fault_test.sh: each strikes the run under way once, and mends itself. Sourced by it.
# shellcheck shell=bash
# shellcheck disable=SC2154 # names that fault_test.sh sets

# roll LO HI: sets rolled. (RANDOM in a subshell would not move on.)
roll() { rolled=$(($1 + (RANDOM * 32768 + RANDOM) % ($2 - $1 + 1))); }
# doze LO HI: some milliseconds between the two; sets dozed.
doze() {
  roll "$1" "$2"
  dozed=$((rolled / 1000)).$(printf %03d $((rolled % 1000)))
  sleep "$dozed"
}

# A task's process dies of signal 9, with its Slurm and its node in good health.
inject_kill() {
  roll 1 "$nodes"
  local first=$rolled turn node
  for ((turn = 0; turn < nodes; turn++)); do
    node=$(((first + turn) % nodes + 1))
    # shellcheck disable=SC2016 # variables of the node's shell
    if "$cluster" exec "$node" bash -c 'for i in {1..20}; do
        pid=$(pgrep -x voxweld | shuf -n 1)
        [ -z "$pid" ] || { kill -9 "$pid" 2>/dev/null && exit; }
        sleep 0.05
      done; exit 1'; then
      what="a task on node $node"
      return 0
    fi
  done
  return 1
}

inject_crash() {
  roll 1 "$nodes"
  local node=$rolled
  "$cluster" crash "$node"
  doze 300 13000
  "$cluster" revive "$node"
  what="node $node for $dozed s"
}

inject_partition() {
  roll 1 "$nodes"
  local node=$rolled
  "$cluster" cut "$node"
  doze 300 20000
  "$cluster" heal "$node"
  what="node $node for $dozed s"
}

inject_controller() {
  "$cluster" kill-controller
  doze 0 5000
  "$cluster" start-controller
  what="for $dozed s"
}

inject_driver() {
  kill -9 "$driver" 2>/dev/null || return 1
  wait "$driver" 2>/dev/null || true
  doze 0 3000
  start_driver
  what="for $dozed s"
}

inject_disk() {
  local filler=$small/filler free
  free=$(df --output=avail -B1 "$small" | tail -n 1)
  roll 0 1
  [ "$rolled" -eq 0 ] || roll 0 400000 # now and then a little is left
  fallocate -l $((free > rolled ? free - rolled : free)) "$filler" 2>/dev/null || true
  local left=$rolled
  doze 1000 18000
  rm -f "$filler"
  what="$left bytes left for $dozed s"
}

# Some task that waits is held in the queue, as Slurm does itself where it cannot launch one.
inject_hold() {
  local tasks
  mapfile -t tasks < <(timeout 10 squeue -h -r -t PD -o '%F_%K' 2>/dev/null)
  [ ${#tasks[@]} -gt 0 ] || return 1
  roll 0 $((${#tasks[@]} - 1))
  timeout 10 scontrol hold "${tasks[rolled]}" || return 1
  what="task ${tasks[rolled]}"
}

# One of those that strike a task, a node or a process, or change what the run is of.
inject_mixed() {
  local kinds=(kill crash partition controller driver input config)
  roll 0 $((${#kinds[@]} - 1))
  local kind=${kinds[rolled]}
  "inject_$kind" && what="$kind: $what"
}

# starve: settings that leave the tasks of the run to come too little memory.
starve() {
  settings=(slurm.retries=1)
  roll 0 3
  case $rolled in
    0) what="slurm.mem below run.memory" && settings+=(slurm.mem=200MiB) ;;
    1) what="slurm.mem above any node's" && settings+=(slurm.mem=64GiB) ;;
    2) # Slurm looks once a second: the merged mesh is held long enough to be seen.
      what="encode has less than it needs"
      # shellcheck disable=SC2016 # the task's shell expands it
      settings+=('slurm.extra=["--mem=40M"]'
        'slurm.prologue=["p=$$; (for i in {1..99}; do kill -STOP $p; sleep 0.3; kill -CONT $p; sleep 0.03; done) 2>/dev/null &"]')
      ;;
    3)
      what="the prologue takes it"
      settings+=("slurm.prologue=['perl -e \"\\\$x = q(a) x 900000000; sleep 3\"']")
      ;;
  esac
}

# is_clear KIND TEXT: whether a run's last words say what to do about it.
is_clear() {
  case $1 in
    disk) grep -qi 'no space left\|is full' <<<"$2" ;;
    hold) grep -q 'held\|Held' <<<"$2" ;;
    memory) grep -q 'slurm\.mem\|run\.memory' <<<"$2" ;;
    *) grep -q 'error: ' <<<"$2" ;;
  esac
}
