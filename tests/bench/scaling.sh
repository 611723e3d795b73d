#!/usr/bin/env bash
# How voxweld's seconds and memory grow with the volume, by stage, and what a second run with one key
# changed saves. --help lists the options.
# Usage: tests/bench/scaling.sh [-o FOLDER] [--sizes 128,256,512] [--threads 1,2] [--times 3] ...
set -euo pipefail
exec /usr/bin/python3 "$(dirname "${BASH_SOURCE[0]}")/scaling.py" "$@"
