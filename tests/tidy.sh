#!/usr/bin/env bash
# Runs clang-tidy (checks in .clang-tidy) over our sources; any warning fails.
# Usage: tests/tidy.sh [BUILD_DIR] [FILE.cpp...]
#   BUILD_DIR must be configured with VOXWELD_UNITY=OFF: its compile_commands.json says how each
#   file is compiled. Default: build-tidy, which is configured so. Without files: all of storage,
#   stages, pipeline and tests that it knows.
set -euo pipefail
case ${1:-} in -h | --help)
  sed -n '2,6s/^# //p' "$0"
  exit 0
  ;;
esac

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
if [ -d "${1:-}" ]; then
  build=$1
  shift
else
  build=$root/build-tidy
  cmake -S "$root" -B "$build" -G Ninja -DVOXWELD_UNITY=OFF >/dev/null
fi
commands=$build/compile_commands.json
if [ ! -f "$commands" ]; then
  echo "tidy: no $commands; configure first: cmake -S . -B $build -G Ninja -DVOXWELD_UNITY=OFF" >&2
  exit 2
fi
files=("$@")
if [ ${#files[@]} -eq 0 ]; then
  mapfile -t files < <(sed -n 's/^ *"file": "\(.*\)",\{0,1\}$/\1/p' "$commands" | sort -u)
fi
# Headers of the packages are not ours to mend: warnings come from ours only (HeaderFilterRegex).
printf '%s\0' "${files[@]}" |
  xargs -0 -n 1 -P "$(nproc)" clang-tidy -p "$build" --quiet --warnings-as-errors='*'
