#!/usr/bin/env bash
# What the scripts of tests share; sourced by them before all else. Sets root, the folder of the
# whole project. Asked for help, a script prints the comment at its head.
# shellcheck disable=SC2034 # used where this is sourced
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
case ${1:-} in -h | --help)
  awk 'NR > 1 { if (!/^#/) exit; sub(/^# ?/, ""); print }' "$0"
  exit 0
  ;;
esac

# require_program PATH ADVICE
require_program() {
  [ -x "$1" ] || {
    echo "no program at $1: $2" >&2
    exit 2
  }
}

# require_known WHAT KNOWN NAME...: each of the names is one of the known, which blanks part.
require_known() {
  local what=$1 known=$2 name
  shift 2
  for name in "$@"; do
    case " $known " in
      *" $name "*) ;;
      *)
        echo "unknown $what: $name; known are: $known" >&2
        exit 2
        ;;
    esac
  done
}

# make_scratch: sets scratch, a folder to write into: VOXWELD_SCRATCH, or a new one that is removed in
# the end.
make_scratch() {
  scratch=${VOXWELD_SCRATCH:-}
  if [ -z "$scratch" ]; then
    scratch=$(mktemp -d)
    trap 'rm -rf "$scratch"' EXIT
  fi
  mkdir -p "$scratch"
}

# tree_hash DIRECTORY [FIND_TEST...]: of all bytes of an output directory but the manifest and the
# report, which have times and hosts in them, the lock, and what the tests of find leave out.
tree_hash() {
  (cd "$1" && shift && find . -type f ! -name manifest.json ! -name report.html ! -name voxweld.lock "$@" -print0 | sort -z |
    xargs -0 sha256sum) | sha256sum | cut -d' ' -f1
}

# bunny_config RAW: of the bunny CT, unpacked into this file.
bunny_config() {
  cat <<TOML
[input]
path = "$1"
format = "raw"
size = [512, 512, 361]
type = "int16"
endian = "big"
spacing = [0.337891, 0.337891, 0.5]
unit = "mm"
[surface]
isovalue = 1150
TOML
}
