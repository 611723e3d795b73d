#!/usr/bin/env bash
# Installs what tests/compare.sh compares with on Debian 12: other people's readers and writers, and
# those of npm (tests/npm_packages.sh). Quiet; does nothing when all of it is there. Needs root or
# sudo only when something is missing.
# Usage: tests/compare/install_packages.sh
set -euo pipefail
# shellcheck source=tests/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/../common.sh"
# shellcheck source=pipeline/apt_packages.sh
source "$root/pipeline/apt_packages.sh"

want python3-numpy python3-nibabel python3-vtk9 python3-zarr python3-numcodecs python3-tifffile \
  python3-pil python3-pydicom python3-gdcm python3-h5py python3-openvdb python3-mrcfile teem-apps \
  libtiff-tools zstd
[ ${#missing[@]} -eq 0 ] || install_missing true true
"$root/tests/npm_packages.sh"
