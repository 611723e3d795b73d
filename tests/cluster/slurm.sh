# Slurm and munge on the machines of the test cluster. Sourced by cluster.sh.
# shellcheck shell=bash
# shellcheck disable=SC2154 # names that cluster.sh and machine.sh set

# ask COMMAND...: a question to slurmctld, which may be down or busy.
ask() { timeout 10 "$@" 2>/dev/null; }

# write_configuration: from nodes, cpus, memory_mb, pin and min_job_age.
write_configuration() {
  local node most_cpus=1
  {
    echo "127.0.0.1 localhost"
    echo "$net.254 $(uname -n)"
    echo "$net.253 head"
    for ((node = 1; node <= nodes; node++)); do echo "$net.$node node$node"; done
  } >"$run/hosts"
  for ((node = 1; node <= nodes; node++)); do
    mkdir -p "$run/node$node"
    [ "${cpus[node - 1]}" -le "$most_cpus" ] || most_cpus=${cpus[node - 1]}
  done
  [ "$pin" -eq 0 ] || deal_cores
  mkdir -p "$run/state"
  # cred_expire: a requeued job waits for its credential to expire first, 121 s if nothing is said.
  # SlurmdTimeout, MessageTimeout: a dead node is missed after 15 s; a busy machine's is not.
  # DefMemPerCPU: a job that names no memory would have all of its node's.
  # OverMemoryKill: measured once a second, by resident size with mapped files. The job ends as
  # FAILED by signal 9, with the reason JobLaunchFailure, where cgroups would say OUT_OF_MEMORY.
  cat >"$SLURM_CONF" <<CONF
ClusterName=voxweld
SlurmctldHost=head($net.253)
SlurmctldPort=$port
SlurmdPort=$((port + 1))
CommunicationParameters=NoCtldInAddrAny
AuthType=auth/munge
AuthInfo=socket=$run/munge/socket,cred_expire=5
SlurmUser=root
StateSaveLocation=$run/state
SlurmdSpoolDir=$run/%n/spool
SlurmctldPidFile=$run/slurmctld.pid
SlurmdPidFile=$run/%n/slurmd.pid
SlurmctldLogFile=$logs/slurmctld.log
SlurmdLogFile=$logs/slurmd-%n.log

SlurmdParameters=config_overrides
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
MpiDefault=none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU_Memory
DefMemPerCPU=$((memory_mb / most_cpus))
JobAcctGatherType=jobacct_gather/linux
JobAcctGatherFrequency=task=1
JobAcctGatherParams=OverMemoryKill

SchedulerType=sched/backfill
SchedulerParameters=batch_sched_delay=0,sched_interval=2,sched_min_interval=100000,bf_interval=2
JobRequeue=1
MaxArraySize=20001
MaxJobCount=50000
MinJobAge=$min_job_age

SlurmdTimeout=6
MessageTimeout=4
KillWait=2
ReturnToService=2
$(for ((node = 1; node <= nodes; node++)); do
    echo "NodeName=node$node NodeAddr=$net.$node CPUs=${cpus[node - 1]} RealMemory=$memory_mb"
  done)
PartitionName=main Nodes=node[1-$nodes] Default=YES MaxTime=INFINITE State=UP
CONF
}

# deal_cores: to each node as many of the cores we may use as it has CPUs, in turn.
deal_cores() {
  local core cores=() node next=0 share count
  while read -r core; do cores+=("$core"); done < <(
    taskset -pc $$ | sed 's/.*: //' | tr , '\n' | while IFS=- read -r first last; do
      seq "$first" "${last:-$first}"
    done
  )
  for ((node = 1; node <= nodes; node++)); do
    share=()
    for ((count = 0; count < cpus[node - 1]; count++)); do
      share+=("${cores[next++ % ${#cores[@]}]}")
    done
    (IFS=, && echo "${share[*]}") >"$run/node$node/cores"
  done
}

# start_munged: one for all nodes; they share its socket as they share the file system.
start_munged() {
  mkdir -p "$run/munge"
  chmod 711 "$run/munge"
  (umask 377 && head -c 1024 /dev/urandom >"$run/munge/key")
  # --force: the folder may lie where others can write, as /tmp is.
  launch head munged --foreground --force --key-file="$run/munge/key" --socket="$run/munge/socket" \
    --pid-file="$run/munge/pid" --log-file="$logs/munged.log" --seed-file="$run/munge/seed"
  wait_for 20 "munged's socket" test -S "$run/munge/socket"
}

controller_processes() {
  local pid
  for pid in $(ip netns pids "$tag-head"); do
    case $(cat "/proc/$pid/comm" 2>/dev/null) in slurm*) echo "$pid" ;; esac
  done
}
controller_is_gone() { [ -z "$(controller_processes)" ]; }
controller_answers() { [[ $(ask scontrol ping) = *" UP"* ]]; }

start_controller() {
  controller_is_gone || fail "slurmctld runs already"
  # shellcheck disable=SC2016 # variables of the inner shell
  launch head "RUN=$run" unshare --mount --uts bash -ec '
    hostname head
    mount --bind "$RUN/hosts" /etc/hosts
    exec env -u RUN slurmctld -D'
  wait_for 60 "slurmctld to answer" controller_answers
}

kill_controller() {
  ! controller_is_gone || fail "slurmctld is down already"
  controller_processes | xargs -r kill -9 2>/dev/null || true
  wait_for 20 "slurmctld to end" controller_is_gone
}

all_nodes_idle() { [ "$(ask sinfo -h -N -t idle -o %N | wc -l)" -eq "$nodes" ]; }
