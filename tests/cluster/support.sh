#!/usr/bin/env bash
# What the tests on the cluster share; sourced by them before all else.
# shellcheck source=tests/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/../common.sh"
here=$root/tests/cluster
cluster=$here/cluster.sh

# require_cluster: ends the test as skipped where a cluster cannot be made.
require_cluster() {
  local missing program
  if ! missing=$("$cluster" supported 2>&1); then
    echo "skipped: $missing"
    exit 77
  fi
  for program in munged slurmctld slurmd sbatch squeue; do
    if ! PATH=$PATH:/usr/sbin command -v "$program" >/dev/null; then
      echo "skipped: $program is not installed; run tests/cluster/install_packages.sh"
      exit 77
    fi
  done
}

# make_shared_folder NAME: sets folder, of a cluster, and data below it, which every node
# sees; both go at the end, and before that, unless ok is set to another value than no, the logs in
# data are shown.
make_shared_folder() {
  folder=$(mktemp -d "/var/tmp/$1.XXXX")
  export VOXWELD_CLUSTER_DIR=$folder
  data=$folder/data
  ok=no
  trap remove_shared_folder EXIT
}
remove_shared_folder() {
  if [ "$ok" = no ]; then
    "$cluster" nodes || true
    timeout 10 squeue || true
    tail -n 30 "$data"/*.log || true
  fi >&2
  "$cluster" stop
  rm -rf "$folder"
}

# install_program FOLDER: below it, where every node sees it; sets voxweld. Where it was built may be
# below /tmp, of which every node has its own.
install_program() {
  mkdir -p "$1/bin"
  cp "$voxweld" "$(dirname "$voxweld")"/libvoxweld_*.so "$1/bin"
  voxweld=$1/bin/voxweld
}

fail() {
  echo "FAILED: $*" >&2
  exit 1
}

began=${EPOCHREALTIME/./}
step() { # step WHAT: says that it is done, and how long it took
  local now=${EPOCHREALTIME/./}
  printf '%5s s  %s\n' "$(((now - began) / 1000000)).$(((now - began) / 100000 % 10))" "$1"
  began=$now
}
