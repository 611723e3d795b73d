#!/usr/bin/env python3
"""Rows of the table of levels of detail, for levels_table.sh.

Usage: levels_table.py NAME OUTPUT_FOLDER BUILD_FOLDER SCRATCH_FOLDER [VOLUME ISOVALUE above|below]

Each level is exported as one mesh and held against the finest by VTK. Beside it the finest mesh is simplified by
meshoptimizer to as many triangles, and so is, where the volume is given, a mesh of it at that scale. Last comes a cut
of the octree with about as many, which the run of SCRATCH_FOLDER/NAME.toml without refine left. Distances are from
points spread by area, 200,000 each way, and from vertices.
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
OCTREE = ("--set", "simplify.refine=off", "--set", "output.levels=1")  # what the run for cuts was given, too


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


class Table:
    """The rows of one volume."""

    def __init__(self, name, output, build, scratch, volume):
        self.name, self.output, self.build, self.scratch, self.volume = name, output, build, scratch, volume
        self.manifest = json.loads((output / "manifest.json").read_text())
        # Triangles between labels are no 2-manifold: there defects say nothing, and nobody else keeps the borders.
        self.shared = (output / "labels.jsonl").exists()
        metre = METRES.get(self.manifest["frame"]["unit"], 1)
        self.stated = {level: error / metre for level, error in stated_errors(output / "tileset.json").items()}
        self.finest = None

    def defects(self, path):
        if self.shared:
            return [""] * 3
        found = defects_of(self.build, path)
        return [found["boundary_edges"], found["nonmanifold_edges"], found["intersecting_pairs"]]

    def peer(self, level, program, source, share):
        simplified = self.scratch / f"{self.name}_{level}_peer.ply"
        called(self.build / "meshopt_simplify", source, simplified, share)
        row(self.name, level, program, read_ply(simplified), self.finest, ["", "", *self.defects(simplified)])

    def octree_cut(self, level, triangles):
        """The cut whose number of triangles is nearest, by halving the range of tolerances."""
        path = self.scratch / f"{self.name}_{level}_octree.ply"
        config = self.scratch / f"{self.name}.toml"
        tolerances, best = [0.1, 1000.0], None
        for _ in range(12):
            tolerance = (tolerances[0] * tolerances[1]) ** 0.5
            said = called(self.build / "voxweld", "extract", config, *OCTREE, "--tolerance", tolerance, "-o", path, "--force")
            found = int(re.search(r"(\d+) triangles", said)[1])
            if best is None or abs(found - triangles) < abs(best[1] - triangles):
                best = tolerance, found
            if abs(found - triangles) < 0.01 * triangles:
                break
            tolerances[0 if found > triangles else 1] = tolerance
        called(self.build / "voxweld", "extract", config, *OCTREE, "--tolerance", best[0], "-o", path, "--force")
        row(self.name, level, "octree", read_ply(path), self.finest, ["", "", *self.defects(path)])

    def remeshed(self, level):
        path = self.scratch / f"{self.name}_{level}_remeshed.ply"
        script = pathlib.Path(__file__).with_name("remeshed_level.py")
        called(sys.executable, script, self.volume[0], level, *self.volume[1:], path)
        return path

    def level(self, entry):
        level = entry["level"]
        path = self.scratch / f"{self.name}_{level}.ply"
        called(self.build / "voxweld", "export", self.output, "--weld", "--level", level, "-o", path, "--force")
        mesh = read_ply(path)
        self.finest = self.finest or mesh
        stated = f"{self.stated[level]:.3g}" if level else ""
        row(self.name, level, "voxweld", mesh, self.finest, [f"{entry['bytes'] / 1e6:.2f}", stated, *self.defects(path)])
        if not level or self.shared:
            return
        triangles = len(mesh.triangles)
        self.peer(level, "meshoptimizer", self.scratch / f"{self.name}_0.ply", triangles / len(self.finest.triangles))
        if self.volume:
            remeshed = self.remeshed(level)
            share = triangles / len(read_ply(remeshed).triangles)
            self.peer(level, "smaller volume, meshoptimizer", remeshed, share)
            self.octree_cut(level, triangles)


def main():
    name, output, build, scratch = sys.argv[1], *(pathlib.Path(path) for path in sys.argv[2:5])
    table = Table(name, output, build, scratch, sys.argv[5:8])
    for entry in table.manifest["levels"]:
        table.level(entry)


if __name__ == "__main__":
    sys.exit(main())
