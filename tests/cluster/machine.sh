# The machines of the test cluster: namespaces, their network, what runs in them. Sourced by
# cluster.sh.
#
#   this machine                     head                              node K
#   (jobs are submitted here)        slurmctld, munged                 slurmd
#                                                                      own pid, mount, uts and
#                                                                      ipc namespaces
#   TAG .254 -------------- uplink | bridge .253 | nodeK ------------- eth0 .K
#
# Head and nodes have a network namespace each, TAG-head and TAG-K. The bridge lies in the head's,
# so that of this machine's network there is one interface, TAG, and none of its firewall's rules
# stand between the nodes. Every process of the cluster is in one of these namespaces: that is how
# all of them are found, also those of a start that was cut short. TAG comes from the folder, and the
# interface's alias names the folder. With a QUOTA each node has a group of the cpu controller too,
# TAG-K, at the top of its hierarchy, and what runs `beside` the nodes has TAG-beside.
# shellcheck shell=bash
# shellcheck disable=SC2034 # names that the other files use

readonly max_nodes=200
readonly system_path=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin
export PATH=$PATH:$system_path

fail() {
  echo "cluster: $*" >&2
  exit 1
}

# wait_for SECONDS WHAT TEST...: until TEST holds.
wait_for() {
  local deadline=$((SECONDS + $1)) what=$2
  shift 2
  until "$@"; do
    [ "$SECONDS" -lt "$deadline" ] || fail "waited in vain for $what"
    sleep 0.1
  done
}

# Sets the names that follow from the cluster's folder: dir, run, logs, tag, net, port, SLURM_CONF.
choose_folder() {
  dir=$(realpath -m "${VOXWELD_CLUSTER_DIR:-${TMPDIR:-/tmp}/voxweld-cluster}")
  [[ $dir =~ ^[A-Za-z0-9._/+-]+$ ]] || fail "slurm.conf has no way to write this folder: $dir"
  [ ${#dir} -le 60 ] || fail "this folder's name is too long for the sockets in it: $dir"
  local number
  number=$(($(printf %s "$dir" | cksum | cut -d' ' -f1) % 512))
  run=$dir/run logs=$dir/log
  tag=vxw$number
  net=198.$((18 + number / 256)).$((number % 256)) # of 198.18.0.0/15, which is for test set-ups
  port=$((20000 + 2 * number))
  export SLURM_CONF=$run/slurm.conf
}

link_owner() { ip -o link show "$tag" 2>/dev/null | sed -n 's/.*alias \([^ ]*\).*/\1/p'; }
owns_link() { [ "$(link_owner)" = "$dir" ]; }
# A start that was cut short may not have come to name the owner.
may_remove_link() { [ -z "$(link_owner)" ] || owns_link; }

refuse_if_taken() {
  ! owns_link || fail "a cluster runs in $dir already"
  [ ! -e "/sys/class/net/$tag" ] ||
    fail "network interface $tag belongs to $(link_owner); choose another VOXWELD_CLUSTER_DIR"
  [ -z "$(namespaces)$(groups_of_cluster)" ] || fail "left behind by an earlier start; run: cluster.sh stop"
  [ -z "$(ip -4 -o addr show to "$net.0/24")" ] ||
    fail "this machine has an address in $net.0/24; choose another VOXWELD_CLUSTER_DIR"
}

# Says what is missing for machines like these, if anything is, by making one.
why_unsupported() {
  [ "$(id -u)" -eq 0 ] || fail "unsupported: needs root"
  local program
  for program in ip unshare nsenter mount taskset setsid; do
    command -v "$program" >/dev/null || fail "unsupported: $program is not installed"
  done
  unshare --pid --fork --mount --mount-proc --uts --ipc true 2>/dev/null ||
    fail "unsupported: no pid, mount, uts and ipc namespaces here (unshare)"
  # shellcheck disable=SC2016 # the inner shell's own variable
  unshare --mount sh -c 'mount -t tmpfs none /dev/shm && mount --bind /dev/shm /tmp' 2>/dev/null ||
    fail "unsupported: no mounts in a mount namespace here"
  { ip link add "vxwp$$" type veth peer name "vxwq$$" && ip link del "vxwp$$"; } 2>/dev/null ||
    fail "unsupported: no right to add network interfaces here"
  # In namespaces of its own: nothing to remove, however this ends.
  unshare --mount --net sh -ec '
    mkdir -p /run/netns
    mount -t tmpfs none /run/netns
    ip netns add probe
    ip link add probe type veth peer name uplink netns probe
    ip -n probe link add bridge type bridge
    ip -n probe link set uplink master bridge up
    nsenter --net=/run/netns/probe true' >/dev/null 2>&1 ||
    fail "unsupported: no network namespaces with veth and bridge here (ip)"
  [ -z "${QUOTA:-}" ] || why_no_quota
}

namespaces() {
  local file
  for file in "/run/netns/$tag-"*; do
    [ ! -e "$file" ] || basename "$file"
  done
}
machines() { namespaces | sed -n "s/^$tag-\([0-9]\{1,\}\)$/\1/p" | sort -n; }
is_machine() { [[ $1 =~ ^[0-9]+$ ]] && [ -e "/run/netns/$tag-$1" ]; }

# Where the cpu controller may be: the tops of its hierarchies, those of version 1 first.
cpu_hierarchies() {
  awk '$3 == "cgroup" && ("," $4 ",") ~ /,cpu,/ { print $2 }' /proc/self/mounts
  awk '$3 == "cgroup2" { print $2 }' /proc/self/mounts
}
groups_of_cluster() {
  local top folder
  for top in $(cpu_hierarchies); do
    for folder in "$top/$tag-"*/; do [ ! -d "$folder" ] || echo "${folder%/}"; done
  done
}

# A period short enough for the speed to be even within a second; the kernel's least quota is 1 ms.
readonly quota_period_us=20000
readonly least_quota=5

# try_group FOLDER PERCENT: makes a group held to so much of a core.
try_group() {
  local top=${1%/*}
  if [ -e "$top/cgroup.controllers" ]; then
    grep -qw cpu "$top/cgroup.controllers" || return 1
    grep -qw cpu "$top/cgroup.subtree_control" || echo +cpu >"$top/cgroup.subtree_control" || return 1
    mkdir "$1" || return 1
    echo "$((quota_period_us * $2 / 100)) $quota_period_us" >"$1/cpu.max" && return 0
  else
    mkdir "$1" || return 1
    echo "$quota_period_us" >"$1/cpu.cfs_period_us" &&
      echo "$((quota_period_us * $2 / 100))" >"$1/cpu.cfs_quota_us" && return 0
  fi
  rmdir "$1"
  return 1
} 2>/dev/null

# why_no_quota: says what is missing for a QUOTA, if anything is, by making a group.
why_no_quota() {
  local top probe
  for top in $(cpu_hierarchies); do
    probe=$top/vxwprobe$$
    if try_group "$probe" 50; then
      rmdir "$probe"
      return 0
    fi
  done
  local tops
  tops=$(cpu_hierarchies | paste -sd ' ')
  fail "unsupported: QUOTA needs the cpu controller of cgroups, and neither cpu.cfs_quota_us" \
    "(version 1) nor cpu.max (version 2) can be set; looked in: ${tops:-none is mounted}"
}

# make_group NAME PERCENT: for a node or what runs beside them.
make_group() {
  local top
  for top in $(cpu_hierarchies); do
    ! try_group "$top/$tag-$1" "$2" || return 0
  done
  fail "cannot make a group of the cpu controller for $1"
}

# enter_group NAME: from now on this process and its children, where there is such a group.
enter_group() {
  local folder
  for folder in $(groups_of_cluster); do
    [ "${folder##*/}" != "$tag-$1" ] || echo "$BASHPID" >"$folder/cgroup.procs"
  done
}

# What still runs there, which is nobody's node, goes on unheld.
removed_group() {
  local pid
  while read -r pid; do
    echo "$pid" >"${1%/*}/cgroup.procs" || true
  done <"$1/cgroup.procs"
  rmdir "$1"
} 2>/dev/null

remove_groups() {
  local folder
  for folder in $(groups_of_cluster); do
    wait_for 20 "the group $folder to be removed" removed_group "$folder"
  done
}

# launch NAME COMMAND...: COMMAND in the network of head or node NAME, detached from the caller.
launch() {
  local name=$1
  shift
  (
    enter_group "$name"
    setsid nsenter --net="/run/netns/$tag-$name" env -i "PATH=$system_path" LANG=C.UTF-8 HOME=/root \
      SHELL=/bin/bash "SLURM_CONF=$SLURM_CONF" "$@" </dev/null >>"$logs/$name.out" 2>&1 &
  )
}

make_head() {
  local head=$tag-head
  ip netns add "$head"
  ip link add "$tag" type veth peer name uplink netns "$head"
  ip link set "$tag" alias "$dir"
  ip addr add "$net.254/24" dev "$tag"
  ip link set "$tag" up
  ip -n "$head" link set lo up
  ip -n "$head" link add bridge type bridge
  ip -n "$head" addr add "$net.253/24" dev bridge
  ip -n "$head" link set uplink master bridge up
  ip -n "$head" link set bridge up
}

make_machine() {
  local name=$tag-$1
  ip netns add "$name"
  ip -n "$name" link add eth0 type veth peer name "node$1" netns "$tag-head"
  ip -n "$name" addr add "$net.$1/24" dev eth0
  ip -n "$name" link set lo up
  ip -n "$name" link set eth0 up
  ip -n "$tag-head" link set "node$1" master bridge
  mkdir -p "$run/node$1/spool" "$run/node$1/tmp"
  chmod 1777 "$run/node$1/tmp"
}

# What becomes a node's first process. The cluster's folder keeps its place below the node's own
# /tmp, where it lies there.
# shellcheck disable=SC2016 # variables of the shell that runs this
readonly init='
  hostname "node$NODE"
  mount --bind "$RUN/hosts" /etc/hosts
  case $DIR in /tmp/*)
    mkdir -p "$RUN/node$NODE$DIR"
    mount --rbind "$DIR" "$RUN/node$NODE$DIR" ;;
  esac
  mount --rbind "$RUN/node$NODE/tmp" /tmp
  mount -t tmpfs -o mode=1777 shm /dev/shm
  cd /
  env -u NODE -u RUN -u DIR slurmd -D -N "node$NODE" &
  wait'

# boot K: starts node K, connected.
boot() {
  [ "$(machine_state "$1")" = down ] || fail "node $1 is up already"
  local on_cores=()
  [ ! -e "$run/node$1/cores" ] || on_cores=(taskset -c "$(cat "$run/node$1/cores")")
  heal_link "$1"
  launch "$1" "NODE=$1" "RUN=$run" "DIR=$dir" "${on_cores[@]}" \
    unshare --pid --fork --mount --mount-proc --uts --ipc bash -ec "$init"
  wait_for 20 "node $1 to boot" is_up "$1"
}

# The process here that is node K's first process there.
first_process() {
  local pid
  for pid in $(ip netns pids "$tag-$1"); do
    if grep -qs '^NSpid:[[:space:]]\+[0-9]\+[[:space:]]\+1$' "/proc/$pid/status"; then
      echo "$pid"
    fi
  done
}

is_up() { [ -n "$(first_process "$1")" ]; }
has_no_process() { [ -z "$(ip netns pids "$1")" ]; }

machine_state() {
  if ! is_up "$1"; then
    echo down
  elif ip -n "$tag-head" -o link show "node$1" | grep -q 'state DOWN'; then
    echo cut
  else
    echo up
  fi
}

cut_link() { ip -n "$tag-head" link set "node$1" down; }
heal_link() { ip -n "$tag-head" link set "node$1" up; }

# crash K: like a power failure. The link goes first: a machine without power refuses no connection.
crash() {
  local first
  first=$(first_process "$1")
  [ -n "$first" ] || fail "node $1 is down already"
  cut_link "$1"
  kill -9 "$first"
  wait_for 20 "the processes of node $1 to be gone" has_no_process "$tag-$1"
}

# run_on K COMMAND...
run_on() {
  local first
  first=$(first_process "$1")
  [ -n "$first" ] || fail "node $1 is down"
  enter_group "$1"
  shift
  # shellcheck disable=SC2016 # variables of the shell on the node
  exec nsenter --target "$first" --pid --mount --uts --ipc --net \
    sh -c 'cd "$0" 2>/dev/null || cd /; exec "$@"' "$PWD" "$@"
}

killed_all_of() {
  ip netns pids "$1" | xargs -r kill -9 2>/dev/null || true
  has_no_process "$1"
}

# Kills what is left of each machine and removes it; the head takes bridge and links with it.
remove_machines() {
  local name
  for name in $(namespaces); do
    wait_for 30 "the processes of $name to end" killed_all_of "$name"
    ip netns del "$name"
  done
  # The head's end of it takes it along, a moment later.
  [ ! -e "/sys/class/net/$tag" ] || ip link del "$tag" 2>/dev/null || [ ! -e "/sys/class/net/$tag" ]
}
