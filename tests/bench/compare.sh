#!/usr/bin/env bash
# Compares two builds by turns, kernel by kernel and in whole runs: ratios of processor seconds, new to
# old, with their spread. --help lists the options.
# Usage: tests/bench/compare.sh OLD_BUILD NEW_BUILD [--times 5] [--filter REGEX] [--runs gyroid,part] ...
set -euo pipefail
exec /usr/bin/python3 "$(dirname "${BASH_SOURCE[0]}")/compare.py" "$@"
