#!/usr/bin/env bash
# Installs the npm packages that tests hold voxweld's files and its viewer against, at the versions of
# package-lock.json, into tests/node_modules: the Khronos glTF validator, meshoptimizer, draco3dgltf, three.js,
# 3d-tiles-renderer, CesiumJS, Neuroglancer with esbuild, which bundles it, puppeteer-core and zarrita.
# Checks that they load. Quiet; does nothing when all of them are there. Without Node.js's npm it installs
# Debian's, which needs root or sudo.
# Usage: tests/npm_packages.sh
set -euo pipefail
# shellcheck source=tests/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
cd "$root/tests"
# shellcheck source=pipeline/apt_packages.sh
source ../pipeline/apt_packages.sh

# The scripts of the tests say by themselves whether their packages load.
loaded() {
  node stages/encode/gltf_validate.mjs && node stages/encode/meshopt_check.mjs &&
    node storage/store/zarrita_check.mjs && node pipeline/view/page_test.mjs &&
    node clients/gltf_check.mjs && node pipeline/neuroglancer/client_test.mjs
}

# npm leaves a copy of the lock behind when it has installed all of it.
installed=node_modules/.package-lock.json
if [ -f "$installed" ] && [ ! package-lock.json -nt "$installed" ] && loaded >/dev/null 2>&1; then
  exit 0
fi
command -v npm >/dev/null || want npm
[ ${#missing[@]} -eq 0 ] || install_missing true true
echo "npm_packages: installing the packages of tests/package-lock.json"
npm ci --silent --no-audit --no-fund </dev/null
loaded
