#!/usr/bin/env bash
# Gives damaged files of every kind to the program (fuzz/README.md).
# Usage: tests/fuzz.sh [--cases N] [--seed S] [--seconds T] [more options of fuzz_files]
# The build folder is BUILD_DIR, if that is set, else build.
set -euo pipefail
# shellcheck source=tests/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
build=${BUILD_DIR:-$root/build}

[ -f "$build/build.ninja" ] || cmake -S "$root" -B "$build" -G Ninja >/dev/null
cmake --build "$build" --target voxweld fuzz_files voxweld_image_module voxweld_tiff_module >/dev/null
"$build/fuzz_files" "$build/voxweld" "$@"
