#!/usr/bin/env bash
# Installs what building, testing and trying voxweld needs on Debian 12. Quiet; does nothing when
# all of it is there. Needs root or sudo only when something is missing.
# Usage: pipeline/install_packages.sh
set -euo pipefail

# shellcheck source=pipeline/apt_packages.sh
source "$(dirname "${BASH_SOURCE[0]}")/apt_packages.sh"

packages=(
  # build
  g++ cmake ninja-build pkg-config git
  # libraries of the program
  libdraco-dev libopenmesh-dev libopenimageio-dev libtbb-dev libtomlplusplus-dev libcli11-dev
  nlohmann-json3-dev libfmt-dev libspdlog-dev libblosc-dev libzstd-dev libxxhash-dev zlib1g-dev
  libeigen3-dev
  # tests and checks
  libgtest-dev libgmock-dev librapidcheck-dev clang-format clang-tidy
  xz-utils zstd time
  # a real scan for the quickstart
  mricron-data
)

want "${packages[@]}"
# Any Node.js will do, also one that does not come from Debian.
command -v node >/dev/null || missing+=(nodejs)
[ ${#missing[@]} -eq 0 ] || install_missing true true
