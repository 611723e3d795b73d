#!/usr/bin/env bash
# Installs what tests/paper needs on Debian 12 beyond what voxweld does: FreeType and a font, for the
# characters of one model. Quiet; does nothing when all of it is there. Needs root or sudo only when
# something is missing.
# Usage: tests/paper/install_packages.sh
set -euo pipefail
# shellcheck source=tests/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/../common.sh"
# shellcheck source=pipeline/apt_packages.sh
source "$root/pipeline/apt_packages.sh"

want libfreetype-dev fonts-wqy-microhei
[ ${#missing[@]} -eq 0 ] || install_missing true true
