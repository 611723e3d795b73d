#!/usr/bin/env bash
# Installs what the test cluster needs on Debian 12: Slurm, munge and iproute2. Starts no service of
# theirs: tests/cluster/cluster.sh runs its own. Quiet; does nothing when all of it is there. Needs
# root or sudo only when something is missing.
# Usage: tests/cluster/install_packages.sh
set -euo pipefail
# shellcheck source=tests/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/../common.sh"
# shellcheck source=pipeline/apt_packages.sh
source "$root/pipeline/apt_packages.sh"

policy=/usr/sbin/policy-rc.d # what Debian asks before it starts a service; 101 is "do not"
own_policy=no
# A policy of the machine's own stays as it is.
forbid_services() {
  [ ! -e "$policy" ] || return 0
  own_policy=yes
  printf '#!/bin/sh\nexit 101\n' | "${as_root[@]}" tee "$policy" >/dev/null
  "${as_root[@]}" chmod 755 "$policy"
}
remove_policy() { [ "$own_policy" = no ] || "${as_root[@]}" rm -f "$policy"; }

want slurm-wlm munge iproute2
[ ${#missing[@]} -eq 0 ] || install_missing forbid_services remove_policy
