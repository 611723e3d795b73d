#!/usr/bin/env bash
# Installs on Debian 12 what tests/clients/run.sh gives voxweld's files to: desktop programs, a browser, VTK, and
# the npm packages (tests/npm_packages.sh). Some 200 MB are fetched. Quiet; does nothing when all of it is there.
# Needs root or sudo only when something is missing.
# Usage: tests/clients/install_packages.sh
set -euo pipefail
# shellcheck source=tests/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/../common.sh"
# shellcheck source=pipeline/apt_packages.sh
source "$root/pipeline/apt_packages.sh"

want python3-numpy python3-vtk9 assimp-utils admesh meshlab xvfb xauth blender xz-utils
# Any Chromium will do.
command -v chromium >/dev/null || command -v google-chrome >/dev/null || want chromium
[ ${#missing[@]} -eq 0 ] || install_missing true true
"$root/tests/npm_packages.sh"
