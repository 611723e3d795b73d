#!/usr/bin/env bash
# That the benchmark still runs: at a small size, one turn, with those peers that can be built here,
# and that every figure is there and plausible. Measures nothing worth reading.
# Usage: tests/bench/small_test.sh run|labels|scaling|compare|kernels BUILD
# Exit status 77 where a program that is needed was not built or is not installed.
set -euo pipefail
# shellcheck source=tests/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/../common.sh"
what=${1:?run, labels, scaling, compare or kernels} build=${2:?a build folder}
here=$root/tests/bench
make_scratch

skip() {
  echo "skipped: $1"
  exit 77
}
[ -x /usr/bin/python3 ] || skip "no /usr/bin/python3"

case $what in
  run)
    "$here/run.sh" --build "$build" -o "$scratch/bench" --only part,gyroid --size 64 --times 1
    # Every mesh is near the true surface, and voxweld's has no defects.
    /usr/bin/python3 - "$scratch/bench/bench.json" <<'PYTHON'
import json
import sys

volumes = json.load(open(sys.argv[1]))["volumes"]
assert set(volumes) == {"part", "gyroid"}, volumes.keys()
for kind, volume in volumes.items():
    assert volume["active_cells"] > 0 and volume["machine"]["cores"] > 0
    assert "voxweld" in volume["programs"], volume["programs"].keys()
    for name, result in volume["programs"].items():
        middle, mesh = result["medians"], result["mesh"]
        what = f"{kind}, {name}"
        assert middle["triangles"] > 100 and middle["output_bytes"] > 1000, what
        assert middle["wall_s"] > 0 and middle["peak_bytes"] > 1e6, what
        assert mesh["mesh_to_surface_by_area"]["mean"] < 0.5, what
        if name == "voxweld":
            defects = mesh["defects"]
            assert defects["nonmanifold_edges"] == defects["boundary_edges"] == 0, what
            assert defects["intersecting_pairs"] == 0, what
PYTHON
    ;;
  labels)
    "$here/labels.sh" --build "$build" -o "$scratch/labels" --size 48 --times 1
    # Closed meshes have an even number of triangles.
    /usr/bin/python3 - "$scratch/labels/labels.json" <<'PYTHON'
import json
import sys

programs = json.load(open(sys.argv[1]))["programs"]
assert "voxweld, each label" in programs and "voxweld, shared" in programs, programs.keys()
for name, turns in programs.items():
    assert turns[0]["triangles"] > 1000, (name, turns)
    assert turns[0]["triangles"] % 2 == 0 or "each label" not in name, (name, turns)
    assert turns[0]["output_bytes"] > 10000, (name, turns)
each = programs["voxweld, each label"][0]["triangles"]
if "FlyingEdges, each label" in programs:  # which simplifies nothing
    assert programs["FlyingEdges, each label"][0]["triangles"] > each
PYTHON
    ;;
  scaling)
    "$here/scaling.sh" --build "$build" -o "$scratch/scaling" --only part --sizes 32,64 \
      --threads 1 --times 1
    /usr/bin/python3 - "$scratch/scaling/scaling.json" <<'PYTHON'
import json
import sys

found = json.load(open(sys.argv[1]))
small, large = found["growth"]
assert 0 < small["active_cells"] < large["active_cells"]
assert {"build", "stitch", "encode"} <= set(large["stages"]), large["stages"].keys()
ran = {row["changed"]: row["ran"] for row in found["second_runs"]}
assert ran["nothing"] == [], ran
assert ran["formats"] == ["encode"], ran
assert "build" in ran["isovalue"], ran
PYTHON
    ;;
  compare)
    "$here/compare.sh" "$build" "$build" --times 1 --filter qr_ --min-time 0.001 --runs part \
      --size 32 | tee "$scratch/compare"
    grep -q "voxweld run, part 32" "$scratch/compare"
    ;;
  kernels)
    [ -x "$build/bench_kernels" ] || skip "bench_kernels was not built: libbenchmark-dev is not installed"
    "$build/bench_kernels" --benchmark_min_time=0.001 2>&1 | tee "$scratch/kernels"
    [ "$(grep -c items_per_second "$scratch/kernels")" -ge 15 ]
    ! grep -q ERROR "$scratch/kernels"
    ;;
  *)
    echo "unknown: $what" >&2
    exit 2
    ;;
esac
