#!/usr/bin/env bash
# What the tests on the cluster share; sourced.

# require_cluster CLUSTER_SH: ends the test as skipped where a cluster cannot be made.
require_cluster() {
  local missing program
  if ! missing=$("$1" supported 2>&1); then
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

# tree_hash DIRECTORY [FIND_TEST...]: of all bytes of an output directory but the manifest, which has
# times and hosts in it, and but what the tests of find leave out.
tree_hash() {
  (cd "$1" && shift && find . -type f ! -name manifest.json "$@" -print0 | sort -z |
    xargs -0 sha256sum) | sha256sum | cut -d' ' -f1
}
