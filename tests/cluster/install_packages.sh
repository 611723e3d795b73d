#!/usr/bin/env bash
# Installs what the test cluster needs on Debian 12: Slurm, munge and iproute2. Starts no service of
# theirs: tests/cluster/cluster.sh runs its own. Quiet; does nothing when all of it is there. Needs
# root or sudo only when something is missing.
# Usage: tests/cluster/install_packages.sh
set -euo pipefail
case ${1:-} in -h | --help)
  sed -n '2,5s/^# //p' "$0"
  exit 0
  ;;
esac

packages=(slurm-wlm munge iproute2)

# True when the package is installed.
is_installed() {
  [ "$(dpkg-query -W -f='${db:Status-Status}' "$1" 2>/dev/null)" = installed ]
}

missing=()
for package in "${packages[@]}"; do
  is_installed "$package" || missing+=("$package")
done
[ ${#missing[@]} -eq 0 ] && exit 0

as_root=()
if [ "$(id -u)" -ne 0 ]; then
  if ! command -v sudo >/dev/null; then
    echo "install_packages: run as root, or install yourself: ${missing[*]}" >&2
    exit 1
  fi
  as_root=(sudo)
fi

log=$(mktemp)
policy=/usr/sbin/policy-rc.d # what Debian asks before it starts a service; 101 is "do not"
own_policy=no
cleanup() {
  rm -f "$log"
  [ "$own_policy" = no ] || "${as_root[@]}" rm -f "$policy"
}
trap cleanup EXIT
apt() {
  if ! "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -qq -o Acquire::Retries=3 \
    -o DPkg::Lock::Timeout=300 "$@" </dev/null >"$log" 2>&1; then
    cat "$log" >&2
    echo "install_packages: apt-get $1 failed" >&2
    exit 1
  fi
}
echo "install_packages: installing ${#missing[@]} packages: ${missing[*]}"
apt update
# A policy of the machine's own stays as it is.
if [ ! -e "$policy" ]; then
  own_policy=yes
  printf '#!/bin/sh\nexit 101\n' | "${as_root[@]}" tee "$policy" >/dev/null
  "${as_root[@]}" chmod 755 "$policy"
fi
apt install -y --no-install-recommends "${missing[@]}"
