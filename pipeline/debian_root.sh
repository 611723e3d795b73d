#!/usr/bin/env bash
# What the scripts that make Debian root file systems share; sourced.

# debian_root TARGET OPTION...: a minimal system of this machine's Debian release, from where its
# apt takes packages, as a folder or a tarball. OPTIONs are mmdebstrap's.
debian_root() {
  local target=$1 settings sources source
  shift
  settings=$(mktemp)
  sources=()
  for source in /etc/apt/sources.list /etc/apt/sources.list.d/debian*.sources; do
    [ ! -s "$source" ] || sources+=("$source")
  done
  # Proxies and the like, which mmdebstrap does not take over by itself.
  apt-config dump | grep -E '^Acquire::(https?|Retries|Check-)[^ ]* "' >"$settings" || true
  local rc=0
  # Made anew after a crash, so dpkg need not wait for the disk.
  mmdebstrap --quiet --variant=minbase --aptopt="$settings" \
    --aptopt='APT::Install-Recommends "false"' --dpkgopt=force-unsafe-io \
    --dpkgopt='path-exclude=/usr/share/man/*' --dpkgopt='path-exclude=/usr/share/locale/*' \
    --dpkgopt='path-exclude=/usr/share/doc/*' --dpkgopt='path-include=/usr/share/doc/*/copyright' \
    "$@" "$(sed -n 's/^VERSION_CODENAME=//p' /etc/os-release)" "$target" "${sources[@]}" || rc=$?
  rm -f "$settings"
  return $rc
}

# recommended_by DEB: the packages that it recommends, by name.
recommended_by() {
  dpkg-deb -f "$1" Recommends | tr ',' '\n' | sed -E 's/^ *([^ (|]+).*/\1/'
}
