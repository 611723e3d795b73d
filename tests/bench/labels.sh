#!/usr/bin/env bash
# Runs voxweld and VTK, label by label, in turn on a volume of labels, and prints what each took.
# --help lists the options.
# Usage: tests/bench/labels.sh [-o FOLDER] [--volume FILE.nrrd] [--times 3] ...
set -euo pipefail
exec /usr/bin/python3 "$(dirname "${BASH_SOURCE[0]}")/labels.py" "$@"
