#!/usr/bin/env python3
"""Rows of the table of levels of detail, for levels_table.sh.

Usage: levels_table.py NAME OUTPUT_FOLDER BUILD_FOLDER SCRATCH_FOLDER

Each level is exported as one mesh and held against the finest by VTK. Beside it the finest mesh is simplified by
meshoptimizer to as many triangles. Distances are from points spread by area, 200,000 each way, and from vertices.
Exits 77 without VTK.
"""
import json
import pathlib
import subprocess
import sys

import tileset_distances as distances
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOPLY import vtkPLYReader

POINTS = 200000


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


def row(name, level, program, mesh, finest, extra):
    measured = [""] * 4
    if mesh is not finest:
        there, back, *most = distances.both_ways(mesh, finest, POINTS)
        measured = [f"{value:.3g}" for value in (there.mean(), back.mean(), *most)]
    columns = [name, level, program, f"{len(mesh.triangles):,}", *extra[:2], *measured, *extra[2:]]
    print("| " + " | ".join(str(column) for column in columns) + " |", flush=True)


def main():
    name, output, build, scratch = sys.argv[1], *(pathlib.Path(path) for path in sys.argv[2:5])
    manifest = json.loads((output / "manifest.json").read_text())
    shared = (output / "labels.jsonl").exists()  # triangles between labels are no 2-manifold: defects say nothing
    finest = None
    for entry in manifest["levels"]:
        level = entry["level"]
        path = scratch / f"{name}_{level}.ply"
        called(build / "voxweld", "export", output, "--weld", "--level", level, "-o", path, "--force")
        mesh = read_ply(path)
        finest = finest or mesh
        stated = f"{max(entry['worst'], entry['tolerance']):.3g}" if level else ""

        def defects(of):
            if shared:
                return [""] * 3
            found = defects_of(build, of)
            return [found["boundary_edges"], found["nonmanifold_edges"], found["intersecting_pairs"]]

        row(name, level, "voxweld", mesh, finest, [f"{entry['bytes'] / 1e6:.2f}", stated, *defects(path)])
        if level and not shared:
            other = scratch / f"{name}_{level}_meshoptimizer.ply"
            share = len(mesh.triangles) / len(finest.triangles)
            called(build / "meshopt_simplify", scratch / f"{name}_0.ply", other, share)
            row(name, level, "meshoptimizer", read_ply(other), finest, ["", "", *defects(other)])


if __name__ == "__main__":
    sys.exit(main())
