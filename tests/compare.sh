#!/usr/bin/env bash
# Compares our readers with independent ones: every file in the folders, voxel for voxel, with
# spacing and orientation. Without folders: the shared data (VOXWELD_SHARED_DATA), where it is, and
# small files of every format that other people's programs write on the spot. Prints a line an
# input and a table. Fails where a file is read differently, where our reader crashes, and where it
# refuses what compare/expected_refusals.txt does not list. It installs nothing:
# tests/compare/install_packages.sh does.
# Usage: tests/compare.sh [--only FORMAT,...] [FOLDER ...]
# Exit status: 0 equal or rightly refused, 1 not so, 3 equal but an independent reader is missing.
# The build folder is BUILD_DIR, if that is set, else build.
set -euo pipefail
# shellcheck source=tests/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
build=${BUILD_DIR:-$root/build}

only=()
if [ "${1:-}" = --only ]; then
  only=(--only "$2")
  shift 2
fi
# Debian's packages are those of Debian's Python.
python=${PYTHON:-python3}
"$python" -c 'import numpy' 2>/dev/null || python=/usr/bin/python3
"$python" -c 'import numpy' 2>/dev/null || {
  echo "no Python with numpy: tests/compare/install_packages.sh installs it" >&2
  exit 2
}
if [ -z "${DUMP_VOLUME:-}" ]; then
  [ -f "$build/build.ninja" ] || cmake -S "$root" -B "$build" -G Ninja >/dev/null
  cmake --build "$build" --target dump_volume >/dev/null
fi
program=${DUMP_VOLUME:-$build/dump_volume}
require_program "$program" "build the target dump_volume"

scratch=$(mktemp -d "${TMPDIR:-/tmp}/voxweld-compare-XXXXXX")
trap 'rm -rf "$scratch"' EXIT
export PYTHONWARNINGS=ignore PYTHONDONTWRITEBYTECODE=1
folders=("$@")
if [ $# -eq 0 ]; then
  mkdir "$scratch/made"
  formats=()
  [ ${#only[@]} -eq 0 ] || formats=(--only "${only[1]}")
  "$python" "$root/tests/compare/make_files.py" "$scratch/made" "${formats[@]}"
  folders=("$scratch/made")
  data=${VOXWELD_SHARED_DATA:-$root/../shared/data}
  if [ -d "$data" ]; then
    folders+=("$data")
  else
    echo "no shared data at $data: only files made here are compared" >&2
  fi
fi
"$python" "$root/tests/compare/compare.py" --program "$program" --scratch "$scratch" "${only[@]}" \
  "${folders[@]}"
