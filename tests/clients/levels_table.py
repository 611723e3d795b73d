#!/usr/bin/env python3
"""Rows of the table of levels of detail, for levels_table.sh.

Usage: levels_table.py NAME OUTPUT_FOLDER BUILD_FOLDER SCRATCH_FOLDER [VOLUME ISOVALUE above|below]

Each level is exported as one mesh and held against the finest by VTK. Beside it the finest mesh is simplified by
meshoptimizer to as many triangles, and so is, where the volume is given, a mesh of it at that scale. Distances are from points spread by area, 200,000 each way, and from vertices.
Exits 77 without VTK.
"""
import json
import pathlib
import re
import subprocess
import sys

import tileset_distances as distances
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOPLY import vtkPLYReader

POINTS = 200000
METRES = {"mm": 1e-3}


def read_ply(path):
    reader = vtkPLYReader()
    reader.SetFileName(str(path))
    reader.Update()
    data = reader.GetOutput()
    points = vtk_to_numpy(data.GetPoints().GetData()).astype(float)
    return distances.Mesh(points, vtk_to_numpy(data.GetPolys().GetConnectivityArray()).reshape(-1, 3).astype("i8"))


def called(*command):
    return subprocess.run([str(part) for part in command], check=True, capture_output=True, text=True).stdout


def defects_of(build, mesh):
    """Open edges, edges of more than two triangles, pairs that intersect."""
    found = json.loads(called(build / "measure_output", mesh, "--reference", mesh, "--points", "1000", "--json"))
    return found["defects"]


def stated_errors(path, found=None):
    """Of each level the largest error that the tileset states of a tile, in metres."""
    found = {} if found is None else found

    def enter(tile):
        uri = tile.get("content", {}).get("uri", "")
        if uri.endswith(".json"):
            return stated_errors(path.parent / uri, found)
        if match := re.search(r"levels/(\d+)/", uri):
            level = int(match[1])
            found[level] = max(found.get(level, 0), tile["geometricError"])
        for child in tile.get("children", []):
            enter(child)

    enter(json.loads(path.read_text())["root"])
    return found


def row(name, level, program, mesh, finest, extra):
    measured = [""] * 4
    if mesh is not finest:
        there, back, *most = distances.both_ways(mesh, finest, POINTS)
        measured = [f"{value:.3g}" for value in (there.mean(), back.mean(), *most)]
    columns = [name, level, program, f"{len(mesh.triangles):,}", *extra[:2], *measured, *extra[2:]]
    print("| " + " | ".join(str(column) for column in columns) + " |", flush=True)


def main():
    name, output, build, scratch = sys.argv[1], *(pathlib.Path(path) for path in sys.argv[2:5])
    volume = sys.argv[5:8]
    manifest = json.loads((output / "manifest.json").read_text())
    shared = (output / "labels.jsonl").exists()  # triangles between labels are no 2-manifold: defects say nothing
    errors = stated_errors(output / "tileset.json")
    metre = METRES.get(manifest["frame"]["unit"], 1)
    finest = None
    for entry in manifest["levels"]:
        level = entry["level"]
        path = scratch / f"{name}_{level}.ply"
        called(build / "voxweld", "export", output, "--weld", "--level", level, "-o", path, "--force")
        mesh = read_ply(path)
        finest = finest or mesh
        stated = f"{errors[level] / metre:.3g}" if level else ""

        def defects(of):
            if shared:
                return [""] * 3
            found = defects_of(build, of)
            return [found["boundary_edges"], found["nonmanifold_edges"], found["intersecting_pairs"]]

        row(name, level, "voxweld", mesh, finest, [f"{entry['bytes'] / 1e6:.2f}", stated, *defects(path)])
        if not level or shared:
            continue

        def peer(program, source, triangles):
            other = scratch / f"{name}_{level}_peer.ply"
            called(build / "meshopt_simplify", source, other, len(mesh.triangles) / triangles)
            row(name, level, program, read_ply(other), finest, ["", "", *defects(other)])

        peer("meshoptimizer", scratch / f"{name}_0.ply", len(finest.triangles))
        if volume:
            anew = scratch / f"{name}_{level}_anew.ply"
            remesh = pathlib.Path(__file__).with_name("remeshed_level.py")
            called(sys.executable, remesh, volume[0], level, *volume[1:], anew)
            peer("mesh of the smaller volume, meshoptimizer", anew, len(read_ply(anew).triangles))


if __name__ == "__main__":
    sys.exit(main())
