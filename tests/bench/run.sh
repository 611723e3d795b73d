#!/usr/bin/env bash
# Runs voxweld and its peers in turn on phantoms, and prints what each took and how good its mesh is:
# seconds, memory, triangles, distances, defects. --help lists the options.
# Usage: tests/bench/run.sh [-o FOLDER] [--only gyroid,part,porous] [--size 512] [--times 5] ...
set -euo pipefail
# Debian's Python: python3-vtk9, which makes the mesh that porous is measured by, is of that one.
exec /usr/bin/python3 "$(dirname "${BASH_SOURCE[0]}")/bench.py" "$@"
