#!/usr/bin/env bash
# Installs on Debian 12 what tests/bench compares voxweld with, and what measures it. Some 50 MB are
# fetched, 240 MB unpacked. Quiet; does nothing when all of it is there. Needs root or sudo only when
# something is missing.
# Usage: tests/bench/install_packages.sh
set -euo pipefail
# shellcheck source=tests/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/../common.sh"
# shellcheck source=pipeline/apt_packages.sh
source "$root/pipeline/apt_packages.sh"

want libopenvdb-dev libvtk9-dev libmeshoptimizer-dev libbenchmark-dev python3-vtk9 python3-numpy
[ ${#missing[@]} -eq 0 ] || install_missing true true
