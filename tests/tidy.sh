#!/usr/bin/env bash
# Runs clang-tidy (checks in .clang-tidy) over our sources; any warning fails.
# Usage: tests/tidy.sh [BUILD_DIR] [--since REV [--most N] | FILE.cpp...]
#   BUILD_DIR must be configured with VOXWELD_UNITY=OFF: its compile_commands.json says how each
#   file is compiled. Default: build-tidy, which is configured so. --since: the sources that are not
#   as in the commit REV, and for a changed header the source of its name; exit status 77 where there
#   is no REV, as in a clone without its history. --most: of these no more than N, those with most
#   changed lines.
#   Without files: all of storage, stages, pipeline and tests that it knows.
set -euo pipefail
# shellcheck source=tests/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
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
known() { sed -n 's/^ *"file": "\(.*\)",\{0,1\}$/\1/p' "$commands" | sort -u; }

# Those with most changed lines first.
changed_since() {
  git -C "$root" diff --numstat --diff-filter=d --no-renames "$1" -- '*.cpp' '*.h' |
    sort -rn | cut -f3 | sed -E "s,^(.*)\.(cpp|h)\$,$root/\1.cpp," | awk '!seen[$0]++'
}

if [ "${1:-}" = --since ]; then
  git -C "$root" rev-parse --quiet --verify "${2:?--since wants a revision}^{commit}" >/dev/null || {
    echo "skipped: $2 is no commit that this clone has"
    exit 77
  }
  mapfile -t files < <(changed_since "$2" | grep -xFf <(known))
  echo "tidy: ${#files[@]} sources changed since $2"
  if [ "${3:-}" = --most ] && [ ${#files[@]} -gt "${4:?--most wants a number}" ]; then
    files=("${files[@]:0:$4}")
    echo "tidy: looking at $4 of them"
  fi
  [ ${#files[@]} -gt 0 ] || exit 0
elif [ $# -gt 0 ]; then
  files=("$@")
else
  mapfile -t files < <(known)
fi
# Headers of the packages are not ours to mend: warnings come from ours only (HeaderFilterRegex).
printf '%s\0' "${files[@]}" |
  xargs -0 -n 1 -P "$(nproc)" clang-tidy -p "$build" --quiet --warnings-as-errors='*'
