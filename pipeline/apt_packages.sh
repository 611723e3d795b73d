#!/usr/bin/env bash
# What the scripts that install Debian packages share; sourced.

missing=()
as_root=()

# want PACKAGE...: those that are not installed are missing.
want() {
  local package
  for package in "$@"; do
    [ "$(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null)" = installed ] ||
      missing+=("$package")
  done
}

# install_missing PREPARE TIDY: what is missing, quietly. Needs root or sudo, which is as_root
# then. PREPARE is called before the first package is installed, TIDY at the script's end.
install_missing() {
  local prepare=$1
  tidy=$2
  if [ "$(id -u)" -ne 0 ]; then
    if ! command -v sudo >/dev/null; then
      echo "install_packages: run as root, or install yourself: ${missing[*]}" >&2
      exit 1
    fi
    as_root=(sudo)
  fi
  log=$(mktemp)
  trap 'rm -f "$log"; "$tidy"' EXIT
  echo "install_packages: installing ${#missing[@]} packages: ${missing[*]}"
  apt update
  "$prepare"
  apt install -y --no-install-recommends "${missing[@]}"
}

apt() {
  if ! "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -qq -o Acquire::Retries=3 \
    -o DPkg::Lock::Timeout=300 "$@" </dev/null >"$log" 2>&1; then
    cat "$log" >&2
    echo "install_packages: apt-get $1 failed" >&2
    exit 1
  fi
}
