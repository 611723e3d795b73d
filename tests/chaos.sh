#!/usr/bin/env bash
# Does what careless users do, at random, and looks at what is left (chaos/README.md).
# Usage: tests/chaos.sh [--steps N] [--seed S] [--seconds T] [more options of chaos]
# The build folder is BUILD_DIR, if that is set, else build.
set -euo pipefail
# shellcheck source=tests/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
build=${BUILD_DIR:-$root/build}

[ -f "$build/build.ninja" ] || cmake -S "$root" -B "$build" -G Ninja >/dev/null
cmake --build "$build" --target voxweld chaos commit_points >/dev/null
"$build/chaos" "$build/voxweld" "$@"
