#!/usr/bin/env bash
# Compares our readers with nibabel and numpy on small files (tests/compare.sh does so with all), and
# makes sure that a wrong sample, a crash and a refusal are seen. Usage: compare_test.sh DUMP_VOLUME
# Exit status: 0, 1, or 77 where Python, numpy or nibabel is missing.
set -euo pipefail
# shellcheck source=tests/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/../common.sh"
program=$1

python=python3
"$python" -c 'import numpy, nibabel' 2>/dev/null || python=/usr/bin/python3
"$python" -c 'import numpy, nibabel' 2>/dev/null || {
  echo "skipped: no Python with numpy and nibabel; tests/compare/install_packages.sh installs them"
  exit 77
}
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
export PYTHON=$python PYTHONWARNINGS=ignore PYTHONDONTWRITEBYTECODE=1
compare() { DUMP_VOLUME=$1 "$root/tests/compare.sh" --only nifti,inrimage,raw "${@:2}"; }

"$python" "$root/tests/compare/make_files.py" "$scratch/made" --only nifti,inrimage,raw
compare "$program" "$scratch/made" >"$scratch/log" || {
  cat "$scratch/log"
  exit 1
}
tail -n 1 "$scratch/log"

# wrong NAME TEXT...: a program that does the text after ours; a failure of that name is to be seen.
mkdir "$scratch/one"
cp "$scratch/made/nifti/i2.nii" "$scratch/one"
wrong() {
  printf '#!/bin/bash\n"%s" "$@"\n[ "$1" = --formats ] || { %s; }\n' "$program" "$2" >"$scratch/wrong"
  chmod +x "$scratch/wrong"
  if compare "$scratch/wrong" "$scratch/one" >"$scratch/log"; then
    echo "not seen: $1"
    exit 1
  fi
  grep -q "i2.nii | nifti | $1" "$scratch/log" || {
    cat "$scratch/log"
    exit 1
  }
}
# shellcheck disable=SC2016 # the program that is written expands it
wrong 'DIFFERENT: 1 samples of slice 0, first at x 3' \
  'n=$(od -An -tu1 -j6 -N1 "$3"); printf "\\x$(printf %02x $((n ^ 1)))" | dd of="$3" bs=1 seek=6 conv=notrunc status=none'
# shellcheck disable=SC2016
wrong 'DIFFERENT: corners are' 'sed -i "/\"origin\"/,/]/s/20\.0/20.01/" "$3.json"'
wrong 'CRASHED' 'exit 139'
wrong 'UNEXPECTED: refused' 'echo no >&2; exit 2'
