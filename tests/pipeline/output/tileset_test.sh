#!/usr/bin/env bash
# A small phantom with levels of detail: its tileset and its glTF files as other programs see them
# (tests/clients). Skipped where Node.js or the packages of tests/npm_packages.sh are missing; without VTK for
# Python the distances are left out.
# Usage: tileset_test.sh VOXWELD
set -euo pipefail
clients=$(cd "$(dirname "${BASH_SOURCE[0]}")/../../clients" && pwd)
program=$(realpath "$1")
command -v node >/dev/null || {
  echo "skipped: no Node.js"
  exit 77
}
node "$clients/gltf_check.mjs" || exit $?
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT
cd "$place"
output='[output]
levels = "auto"
tile_vertices = 1024
formats = ["glb", "meshopt"]
report = false'
cat >porous.toml <<TOML
[input]
path = "porous.nrrd"
spacing = [0.5, 0.5, 0.75]
unit = "mm"
[surface]
isovalue = 32767.5
inside = "below"
$output
TOML
# A mesh for each label, many in one coarse tile.
cat >grains.toml <<TOML
[input]
path = "grains.nrrd"
[labels]
mode = "each"
$output
TOML
for one in porous grains; do
  kind=${one/grains/labels}
  { "$program" phantom "$kind" --size 96 -o "$one.nrrd" && "$program" run "$one.toml"; } >log.txt 2>&1 || {
    cat log.txt
    exit 1
  }
done
node "$clients/tileset_check.mjs" --dump tiles porous.mesh/tileset.json
node "$clients/tileset_check.mjs" --labels grains.mesh/tileset.json
node "$clients/gltf_check.mjs" porous.mesh grains.mesh
python=${PYTHON:-python3}
"$python" -c 'import vtkmodules' 2>/dev/null || python=/usr/bin/python3
status=0
"$python" "$clients/tileset_distances.py" --points 3000 tiles || status=$?
[ $status -eq 0 ] || [ $status -eq 77 ] || exit 1

# What the checks are for: each of these has to be found.
node - porous.mesh/tileset.json <<'JS'
const { readFileSync, writeFileSync } = require("node:fs");
const path = process.argv[2], text = readFileSync(path, "utf8");
const damaged = {
  error: (t) => (t.geometricError = t.root.geometricError),
  negative: (t) => (t.root.geometricError = -1),
  unknown: (t) => (t.root.errors = 1),
  refine: (t) => delete t.root.refine,
  box: (t) => (t.root.children[0].boundingVolume.box[3] *= 0.9),
  numbers: (t) => t.root.boundingVolume.box.pop(),
  hole: (t) => t.root.children[0].children.pop(),
};
for (const [name, change] of Object.entries(damaged)) {
  const document = JSON.parse(text);
  change(document);
  writeFileSync(path.replace("tileset.json", `damaged_${name}.json`), JSON.stringify(document));
}
JS
for damaged in porous.mesh/damaged_*.json; do
  if node "$clients/tileset_check.mjs" "$damaged" >damaged.txt 2>&1 || grep -q "^    at " damaged.txt; then
    cat damaged.txt
    echo "not found: $damaged"
    exit 1
  fi
done
