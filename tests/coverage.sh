#!/usr/bin/env bash
# Runs all tests in a build that counts lines and prints, for each source file of ours, the share
# of its lines that ran, lowest first, and the total.
# Usage: tests/coverage.sh
set -euo pipefail
# shellcheck source=tests/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
build=$root/build-coverage
jobs=$(nproc)

cmake -C "$root/configs/presets/coverage.cmake" -S "$root" -B "$build" -G Ninja >/dev/null
cmake --build "$build" -j "$jobs"
find "$build" -name '*.gcda' -delete
ctest --test-dir "$build" --output-on-failure -j "$jobs"

# A source file is compiled once, so its one report is all of it; headers are left out.
find "$build/storage" "$build/stages" "$build/pipeline" -name '*.gcda' -print0 |
  xargs -0 -r gcov --no-output --relative-only --source-prefix "$root" 2>/dev/null |
  awk -F"[':% ]+" '
    /^File / { file = $2; wanted = file ~ /^(storage|stages|pipeline)\/.*\.cpp$/ }
    /^Lines executed/ && wanted {
      percent = $3; lines = $5; wanted = 0
      printf "%6.1f %%  of %5d lines  %s\n", percent, lines, file | "sort -n"
      all += lines; run += lines * percent / 100
    }
    END { close("sort -n"); if (all) printf "%6.1f %%  of %5d lines  in all\n", 100 * run / all, all }'
