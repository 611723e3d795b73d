#!/usr/bin/env bash
# Bundling the viewer's page where npm works, fails or is not wanted, without a network. npm is
# `false` here, so that whatever asks it for anything fails.
# Usage: bundle_test.sh VIEW_FOLDER BUNDLE
#   VIEW_FOLDER: pipeline/view; BUNDLE: where a build has bundled the page
# Exits 77 where no build has.
set -euo pipefail
view=$1 built=$2
[ -f "$built/installed.txt" ] || {
  echo "skipped: this build has not bundled the page"
  exit 77
}
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT

fail() {
  echo "FAILED: $*: $(cat "$place/log")" >&2
  exit 1
}

# bundle VIEWER FOLDER
bundle() {
  cmake "-DVIEWER=$1" "-DPAGE=$view/page" "-DBUNDLE=$2" "-DLIST=$2/list.cpp" \
    -DNPM="$(type -P false)" -DNODE="$(type -P node || type -P nodejs)" -P "$view/bundle.cmake" >"$place/log" 2>&1
}
files_in() { grep -c '^VOXWELD_PAGE_FILE' "$1/list.cpp" || true; }

bundle OFF "$place/off" || fail "OFF"
[ "$(files_in "$place/off")" = 0 ] || fail "OFF has a page"

bundle AUTO "$place/auto" || fail "AUTO without npm is no failure"
[ "$(files_in "$place/auto")" = 0 ] || fail "AUTO without npm has a page"
grep -q 'the program is built without it' "$place/log" || fail "AUTO does not say what is missing"

! bundle ON "$place/on" || fail "ON goes on without npm"
grep -q 'npm cannot install what the page needs' "$place/log" || fail "ON does not say why"

# What is installed is not installed again while the lock is the same.
mkdir "$place/again"
cp "$built/installed.txt" "$built/package.json" "$place/again"
cp -r "$built/node_modules" "$place/again/node_modules"
bundle ON "$place/again" || fail "bundling again asks npm"
for name in index.html viewer.js viewer.css licences.txt draco/draco_decoder.wasm draco/draco_wasm_wrapper.js; do
  grep -q "/files/$name\"" "$place/again/list.cpp" || fail "$name is not bundled"
done
grep -q '3d-tiles-renderer .*Apache-2.0' "$place/again/files/licences.txt" || fail "a licence is missing"
! grep -qE 'https?://[^ ]*(npm|registry)' "$place/again/files/viewer.js" || fail "addresses of a registry"
echo other >"$place/again/installed.txt"
! bundle ON "$place/again" || fail "another lock needs no npm"

# Nothing is written beside the sources.
[ ! -e "$view/page/node_modules" ] || fail "node_modules beside the sources"
! grep -q '"resolved"' "$view/page/package-lock.json" || fail "addresses in package-lock.json"
echo "bundle: as it should be"
