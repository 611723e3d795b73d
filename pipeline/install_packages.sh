#!/usr/bin/env bash
# Installs what building, testing and trying voxweld needs on Debian 12. Quiet; does nothing when
# all of it is there. Needs root or sudo only when something is missing.
# Usage: pipeline/install_packages.sh
set -euo pipefail

packages=(
  # build
  g++ cmake ninja-build pkg-config git
  # libraries of the program
  libdraco-dev libopenmesh-dev libopenimageio-dev libtbb-dev libtomlplusplus-dev libcli11-dev
  nlohmann-json3-dev libfmt-dev libspdlog-dev libblosc-dev libzstd-dev libxxhash-dev zlib1g-dev
  libeigen3-dev
  # tests and checks
  libgtest-dev libgmock-dev librapidcheck-dev libbenchmark-dev clang-format clang-tidy
  xz-utils zstd time
  # a real scan for the quickstart
  mricron-data
)

# True when the package is installed.
is_installed() {
  [ "$(dpkg-query -W -f='${db:Status-Status}' "$1" 2>/dev/null)" = installed ]
}

missing=()
for package in "${packages[@]}"; do
  is_installed "$package" || missing+=("$package")
done
# Any Node.js will do, also one that does not come from Debian.
command -v node >/dev/null || missing+=(nodejs)
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
trap 'rm -f "$log"' EXIT
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
apt install -y --no-install-recommends "${missing[@]}"
