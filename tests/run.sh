#!/usr/bin/env bash
# Builds everything (Release) and runs all tests; tests/install_packages.sh has what that needs.
# Closes on ctest's own summary, which is kept in BUILD_DIR/ctest.log.
# Usage: tests/run.sh [BUILD_DIR]        (default: build, which pipeline/quickstart.sh shares)
set -euo pipefail
# shellcheck source=tests/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
build=${1:-$root/build}
jobs=$(nproc)

# What the configuration finds is of interest only when it fails.
if ! configured=$(cmake -S "$root" -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release \
  -DVOXWELD_TESTS=ON 2>&1); then
  printf '%s\n' "$configured" >&2
  exit 1
fi
cmake --build "$build" -j "$jobs"
ctest --test-dir "$build" --output-on-failure -j "$jobs" 2>&1 | tee "$build/ctest.log"
