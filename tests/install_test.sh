#!/usr/bin/env bash
# Installs a build into an empty folder and uses it from there: what lies where, the module found
# from bin, the manual page and completions as the program prints them.
# Usage: tests/install_test.sh BUILD
set -euo pipefail

build=$(cd "$1" && pwd)
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT
at=$place/usr
cmake --install "$build" --prefix "$at" >/dev/null

fail() {
  echo "install: $*" >&2
  exit 1
}
share=share/doc/voxweld
for file in bin/voxweld lib/voxweld/libvoxweld_image.so lib/voxweld/libvoxweld_server.so \
  lib/voxweld/libvoxweld_tiff.so $share/README.md $share/copyright \
  $share/SETTINGS.md $share/examples/example.toml $share/examples/workflow.smk \
  share/man/man1/voxweld.1 share/bash-completion/completions/voxweld \
  share/zsh/vendor-completions/_voxweld share/fish/vendor_completions.d/voxweld.fish; do
  [ -s "$at/$file" ] || fail "$file is missing"
done
others=$(find "$at" -type f \( -name '*.a' -o -name '*.h' -o -name 'test_*' \))
[ -z "$others" ] || fail "is no part of a package: $others"

voxweld=$at/bin/voxweld
"$voxweld" manual | cmp - "$at/share/man/man1/voxweld.1"
"$voxweld" completion bash | cmp - "$at/share/bash-completion/completions/voxweld"
cd "$place"
"$voxweld" phantom sphere --size 24 -o ball.nrrd
"$voxweld" init ball.nrrd
"$voxweld" run ball.toml
"$voxweld" render ball.mesh -o ball.png --width 40 --height 30
[ -s ball.png ] || fail "the module for images was not found"
echo "install: in order"
