#!/usr/bin/env bash
# Builds with sanitizers and runs tests under them; any finding fails.
# Usage: tests/sanitize.sh asan|tsan [TEST_PROGRAM...]
#        tests/sanitize.sh clang TEST_PROGRAM...
#   asan: addresses, leaks and undefined behaviour; tsan: data races; clang: what asan looks for, built
#   by clang together with tests/coverage_fuzz.sh, which is quicker where both are wanted.
#   With test programs named (test_storage ...) only those are built and run, else all of ctest.
set -euo pipefail
usage() { sed -n '2,7s/^# //p' "${BASH_SOURCE[0]}"; }

kind=${1:-}
folder=build-$kind preset=$kind
case $kind in
  asan | tsan) shift ;;
  clang)
    shift
    folder=build-fuzz preset=fuzzers
    [ $# -gt 0 ] || {
      echo "clang: name the test programs to run; see --help" >&2
      exit 2
    }
    ;;
  -h | --help)
    usage
    exit 0
    ;;
  *)
    usage >&2
    exit 2
    ;;
esac
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
build=$root/$folder
jobs=$(nproc)

export ASAN_OPTIONS=${ASAN_OPTIONS:-strict_string_checks=1:detect_stack_use_after_return=1}
export UBSAN_OPTIONS=${UBSAN_OPTIONS:-print_stacktrace=1:halt_on_error=1}
export TSAN_OPTIONS=${TSAN_OPTIONS:-halt_on_error=1:second_deadlock_stack=1:history_size=7:suppressions=$root/configs/presets/tsan_suppressions.txt}
# The thread sanitizer of GCC 12 does not start where addresses are randomized over more bits than
# it expects.
fixed_addresses=()
if [ "$kind" = tsan ] && setarch "$(uname -m)" -R true 2>/dev/null; then
  fixed_addresses=(setarch "$(uname -m)" -R)
fi

cmake -C "$root/configs/presets/$preset.cmake" -S "$root" -B "$build" -G Ninja >/dev/null
if [ $# -eq 0 ]; then
  "${fixed_addresses[@]}" cmake --build "$build" -j "$jobs"
  "${fixed_addresses[@]}" ctest --test-dir "$build" --output-on-failure -j "$jobs"
else
  "${fixed_addresses[@]}" cmake --build "$build" -j "$jobs" --target "$@"
  # In shards, since one program may have all the long tests, and in many, since one shard may.
  shards=$((8 * jobs))
  for program in "$@"; do
    echo "$kind: $program"
    seq 0 $((shards - 1)) |
      xargs -P "$jobs" -I{} env GTEST_TOTAL_SHARDS="$shards" GTEST_SHARD_INDEX={} \
        "${fixed_addresses[@]}" "$build/$program" --gtest_brief=1
  done
fi
