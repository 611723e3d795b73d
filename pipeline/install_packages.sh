#!/usr/bin/env bash
# Installs what building and trying voxweld needs on Debian 12. Quiet; does nothing when all of it
# is there. Needs root or sudo only when something is missing. What tests and checks need as well:
# tests/install_packages.sh. Node.js's npm is left to you: with it the build has a viewer
# (pipeline/view/README.md).
# Usage: pipeline/install_packages.sh
set -euo pipefail

# shellcheck source=pipeline/apt_packages.sh
source "$(dirname "${BASH_SOURCE[0]}")/apt_packages.sh"

packages=(
  # build
  g++ cmake ninja-build pkg-config
  # libraries
  libdraco-dev libmeshoptimizer-dev libopenmesh-dev libopenimageio-dev libtiff-dev libpugixml-dev libtbb-dev libtomlplusplus-dev libcli11-dev
  nlohmann-json3-dev libfmt-dev libspdlog-dev libblosc-dev libzstd-dev libxxhash-dev zlib1g-dev libpng-dev
  liblz4-dev libbz2-dev liblzma-dev libeigen3-dev libcurl4-openssl-dev libcpp-httplib-dev libpugixml-dev libgdcm-dev
  libhdf5-dev libopenvdb-dev libimath-dev
  # a real scan for the quickstart
  mricron-data
)

want "${packages[@]}"
[ ${#missing[@]} -eq 0 ] || install_missing true true
