#!/usr/bin/env bash
# Runs a small phantom through configs/workflow.smk and holds it to `voxweld run`: the same files, a
# second run that does nothing, an edited config, and a run that fails and goes on. Exits 77
# (skipped) where Snakemake is not installed.
# Usage: tests/cluster/snakemake_test.sh [VOXWELD]        (default: build/voxweld)
set -euo pipefail
# shellcheck source=tests/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/../common.sh"
voxweld=$(realpath "${1:-$root/build/voxweld}")
if ! command -v snakemake >/dev/null; then
  echo "skipped: snakemake is not installed"
  exit 77
fi

folder=$(mktemp -d "${TMPDIR:-/tmp}/vxwsnake.XXXX")
trap 'rm -rf "$folder"' EXIT
# A blank in the paths, as users have them.
mkdir "$folder/my scan"
cd "$folder/my scan"
export HOME=$folder XDG_CACHE_HOME=$folder/cache

fail() {
  echo "FAILED: $*" >&2
  tail -n 40 "$folder/log" >&2 || true
  exit 1
}

workflow() { # workflow OPTION...: what it says is left in $folder/log
  snakemake -s "$root/configs/workflow.smk" --cores 2 --nocolor \
    --config config=scan.toml parts=3 threads=1 mem_mb=100 "voxweld=$voxweld" "$@" \
    >"$folder/log" 2>&1
}
commands_run() { grep -c '^rule \(part\|whole\):' "$folder/log" || true; }
same_as_reference() { # all files but the manifest and the report, which have the times
  diff -r -x manifest.json -x report.html ../reference/scan.mesh scan.mesh >>"$folder/log" || fail "$1"
  "$voxweld" verify scan.mesh >>"$folder/log" 2>&1 || fail "verify: $1"
}

mkdir data
"$voxweld" --log-level warning phantom gyroid --size 64 -o data/scan.nrrd >/dev/null
cat >scan.toml <<'CONFIG'
[input]
path = "data/scan.nrrd"
[surface]
isovalue = "otsu"
[work]
brick = 16
shard = 2
copy = true
[output]
tile_vertices = 1024
[simplify]
tolerance = 0.001
CONFIG
mkdir ../reference
cp -r scan.toml data ../reference
"$voxweld" --log-level warning run ../reference/scan.toml >"$folder/log" 2>&1 || fail "voxweld run"
[ "$(find ../reference/scan.mesh/tiles -name '*.drc' | wc -l)" -gt 3 ] || fail "fewer tiles than parts"

workflow || fail "the workflow"
[ "$(commands_run)" -eq 30 ] || fail "$(commands_run) commands were run, not 9 times 3 and 3"
same_as_reference "other files than voxweld run"
echo "30 commands: the files of voxweld run"

workflow || fail "the workflow a second time"
[ "$(commands_run)" -eq 0 ] || fail "a second run ran $(commands_run) commands"
echo "a second run: nothing to do"

edited() { # edited LINE COMMANDS [OPTION...]: the config with one more line
  echo "$1" | tee -a scan.toml >>../reference/scan.toml
  "$voxweld" --log-level warning run ../reference/scan.toml >"$folder/log" 2>&1 || fail "voxweld run"
  workflow "${@:3}" || fail "the workflow with $1"
  [ "$(commands_run)" -eq "$2" ] || fail "$(commands_run) commands were run, not $2, with $1"
  same_as_reference "other files with $1"
}
edited 'metric = "sum"' 30
echo "an edited config: the files of voxweld run"
edited 'ratio = 0.3' 36 target=1
echo "a number of triangles: two stages more, the files of voxweld run"
sed -i '/^ratio/d' scan.toml ../reference/scan.toml
sed -i '/^\[output\]/a levels = "auto"' scan.toml ../reference/scan.toml
"$voxweld" --log-level warning run ../reference/scan.toml >"$folder/log" 2>&1 || fail "voxweld run"
workflow levels=1 || fail "the workflow with levels of detail"
[ "$(commands_run)" -eq 31 ] || fail "$(commands_run) commands were run, not 31, with levels of detail"
same_as_reference "other files with levels of detail"
echo "levels of detail: a stage more, the files of voxweld run"
sed -i '/^levels/d' scan.toml ../reference/scan.toml
edited 'refine = "off"' 15 refine=0
echo "without refine: five stages fewer, the files of voxweld run"
sed -i '/^refine/d' scan.toml ../reference/scan.toml
edited $'refine = "repair"\nintersections = "report"' 21 seams=0
echo "only what intersects is counted: three stages fewer, the files of voxweld run"
sed -i '/^refine/d; /^intersections/d' scan.toml ../reference/scan.toml
"$voxweld" --log-level warning run ../reference/scan.toml >"$folder/log" 2>&1 || fail "voxweld run"

# The input is gone for a moment when a part of the build is done.
rm -rf scan.mesh scan.work scan.done
workflow -- "$PWD/scan.done/build-0-of-3" || fail "one part of the build"
[ "$(commands_run)" -eq 5 ] || fail "$(commands_run) commands were run for one part, not 4 and it"
mv data away # the file itself is not touched
if workflow; then fail "it went through without its input"; fi
grep -q 'scan.nrrd' "$folder/log" || fail "the file that is missing is not named"
mv away data
workflow || fail "the run after the failed one"
[ "$(commands_run)" -eq 25 ] || fail "$(commands_run) commands were run after 5, not the other 25"
same_as_reference "other files after a failed run"
echo "a run that failed: went on, the files of voxweld run"
