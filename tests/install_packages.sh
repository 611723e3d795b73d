#!/usr/bin/env bash
# Installs what tests and checks need on Debian 12, the program's packages with it. Quiet; does
# nothing when all of it is there. Needs root or sudo only when something is missing.
# Usage: tests/install_packages.sh
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
"$root/pipeline/install_packages.sh"

# shellcheck source=pipeline/apt_packages.sh
source "$root/pipeline/apt_packages.sh"

packages=(
  # tests
  libgtest-dev libgmock-dev librapidcheck-dev libbenchmark-dev git xz-utils zstd time
  # other readers and writers of volumes
  python3-numpy python3-zarr python3-vtk9 python3-mrcfile python3-pydicom python3-gdcm
  dcmtk python3-openvdb python3-h5py python3-numcodecs python3-nibabel python3-tifffile libtiff-tools
  # checks
  clang-format clang-tidy clang libclang-rt-dev
)

want "${packages[@]}"
# Any Node.js will do, also one that does not come from Debian.
command -v node >/dev/null || missing+=(nodejs)
[ ${#missing[@]} -eq 0 ] || install_missing true true
