#!/usr/bin/env bash
# Careless use (tests/chaos) with a test cluster at hand: a part of the runs goes to it, alone and
# at once with runs from here on the same folders. Exits 77 (skipped) where a cluster cannot be made.
# Usage: tests/cluster/chaos_test.sh [option of chaos...]        (default: --seed 1 --steps 25)
# Environment: BUILD_DIR (the build folder, default build). The folder of an episode that failed is
# kept where --keep says.
set -euo pipefail
# shellcheck source=tests/cluster/support.sh
source "$(dirname "${BASH_SOURCE[0]}")/support.sh"
build=${BUILD_DIR:-$root/build}
for program in chaos voxweld commit_points.so; do
  require_program "$build/$program" "build it, or name its folder in BUILD_DIR"
done
keep=${TMPDIR:-/tmp}/voxweld-chaos-failures
options=("$@")
[ $# -gt 0 ] || options=(--seed 1 --steps 25)
require_cluster
make_shared_folder vxwchaos

voxweld=$build/voxweld
install_program "$data"
cp "$build/commit_points.so" "$data/bin" # tasks are killed at their commits as well
eval "$(CPUS=2 "$cluster" start)"
step "a cluster of three nodes"
ok=yes # an episode that fails tells its own story

TMPDIR=$data "$build/chaos" "$voxweld" --cluster --keep "$keep" "${options[@]}"
step "careless use"
