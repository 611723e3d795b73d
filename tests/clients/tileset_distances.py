#!/usr/bin/env python3
"""How far each coarser tile of a tileset lies from the finest tiles that it stands for, and they from it.

Usage: tileset_distances.py [--points N] [--json] FOLDER    (a folder of tileset_check.mjs --dump)

VTK (vtkImplicitPolyDataDistance) measures the distances, in metres. Of each tile: from N points of its
triangles, spread by area, and from its vertices to the finest tiles below it; and from as many of these to
the tile. "Within" is the share of the points, by area, that lie within the error that the tileset states of
their tile.
The error is a percentile: a few points lie farther off, and the greatest distance is told.
Exits 1 where less than 97 % of a level's points are within, 77 without VTK.
"""
import argparse
import json
import pathlib
import sys

try:
    import numpy as np
    from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray, vtk_to_numpy
    from vtkmodules.vtkCommonCore import vtkDoubleArray, vtkPoints
    from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData
    from vtkmodules.vtkFiltersCore import vtkImplicitPolyDataDistance
except ImportError as error:
    print(f"skipped: no VTK or no numpy for Python ({error}); Debian: python3-vtk9")
    sys.exit(77)

SHARE = 0.97


class Mesh:
    def __init__(self, points, triangles):
        # Triangles of no area have no place in a test of distances.
        a, b, c = (points[triangles[:, k]] for k in range(3))
        self.areas = np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2
        self.points, self.triangles = points, triangles

    @staticmethod
    def joined(meshes):
        starts = np.cumsum([0] + [len(m.points) for m in meshes[:-1]])
        return Mesh(np.concatenate([m.points for m in meshes]),
                    np.concatenate([m.triangles + s for m, s in zip(meshes, starts)]))

    def sampled(self, count, random):
        """Vertices, and points of the triangles by area: (points, how many of them are vertices)."""
        corners = np.unique(self.triangles)
        if len(corners) > count:
            corners = random.choice(corners, count, replace=False)
        share = np.cumsum(self.areas)
        at = np.minimum(np.searchsorted(share, random.random(count) * share[-1]), len(self.triangles) - 1)
        u, v = random.random((2, count))
        over = u + v > 1
        u[over], v[over] = 1 - u[over], 1 - v[over]
        a, b, c = (self.points[self.triangles[at, k]] for k in range(3))
        inner = a + u[:, None] * (b - a) + v[:, None] * (c - a)
        return np.concatenate([self.points[corners], inner]), len(corners)

    def distance(self):
        data, points, cells = vtkPolyData(), vtkPoints(), vtkCellArray()
        points.SetData(numpy_to_vtk(self.points, deep=True))
        kept = self.triangles[self.areas > 0].astype(np.int64)
        cells.SetData(numpy_to_vtkIdTypeArray(np.arange(0, 3 * len(kept) + 1, 3, dtype=np.int64), deep=True),
                      numpy_to_vtkIdTypeArray(kept.reshape(-1), deep=True))
        data.SetPoints(points)
        data.SetPolys(cells)
        function = vtkImplicitPolyDataDistance()
        function.SetInput(data)

        def of(at):
            out = vtkDoubleArray()
            function.FunctionValue(numpy_to_vtk(np.ascontiguousarray(at), deep=True), out)
            return np.abs(vtk_to_numpy(out))

        return of


def both_ways(tile, finest, count, seed=1):
    """Two arrays of distances, points spread by area, and the greatest of all."""
    random = np.random.default_rng(seed)
    there, vertices_there = tile.sampled(count, random)
    back, vertices_back = finest.sampled(count, random)
    to_finest, to_tile = finest.distance()(there), tile.distance()(back)
    return to_finest[vertices_there:], to_tile[vertices_back:], to_finest.max(), to_tile.max()


def read(folder):
    index = json.loads((folder / "tiles.json").read_text())
    meshes = {}
    for tile in index["tiles"]:
        number = tile["number"]
        meshes[number] = Mesh(np.fromfile(folder / f"{number}.points", dtype="<f8").reshape(-1, 3),
                              np.fromfile(folder / f"{number}.corners", dtype="<u4").reshape(-1, 3).astype(np.int64))
    return index["tiles"], meshes


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--points", type=int, default=20000)
    parser.add_argument("--json", action="store_true")
    parser.add_argument("folder", type=pathlib.Path)
    options = parser.parse_args()
    tiles, meshes = read(options.folder)
    levels, breaches = {}, []
    for tile in tiles:
        row = levels.setdefault(tile["height"], {"tiles": 0, "triangles": 0, "stated": 0.0, "to_finest": [], "to_level": [],
                                                 "within": [], "max_to_finest": 0.0, "max_to_level": 0.0, "ratio_to_finest": 0.0, "ratio_to_level": 0.0})
        row["tiles"] += 1
        row["triangles"] += len(meshes[tile["number"]].triangles)
        if tile["height"] == 0:
            continue
        finest = Mesh.joined([meshes[leaf] for leaf in tile["leaves"]])
        there, back, most_there, most_back = both_ways(meshes[tile["number"]], finest, options.points)
        row["stated"] = max(row["stated"], tile["error"])
        row["to_finest"].append(there)
        row["to_level"].append(back)
        row["max_to_finest"] = max(row["max_to_finest"], float(most_there))
        row["max_to_level"] = max(row["max_to_level"], float(most_back))
        row["within"].append([np.mean(there <= tile["error"]), np.mean(back <= tile["error"])])
        for name, most in (("to_finest", most_there), ("to_level", most_back)):
            row["ratio_" + name] = max(row["ratio_" + name], float(most / tile["error"]))
    for height, row in sorted(levels.items()):
        for name in ("to_finest", "to_level"):
            values = row.pop(name)
            row[f"mean_{name}"] = float(np.mean(np.concatenate(values))) if values else 0.0
            row[f"p99_{name}"] = float(np.quantile(np.concatenate(values), 0.99)) if values else 0.0
        row["within"] = float(np.min(np.mean(row["within"], axis=0))) if row["within"] else 1.0
        if row["within"] < SHARE:
            breaches.append(f"level {height}: only {row['within']:.1%} of the points are within the stated error")
        if not options.json and height > 0:
            print(f"  level {height}: {row['tiles']} tiles, {row['triangles']} triangles; stated {row['stated']:.4g} m; "
                  f"to the finest mean {row['mean_to_finest']:.4g}, 99 % {row['p99_to_finest']:.4g}, max {row['max_to_finest']:.4g}; "
                  f"back mean {row['mean_to_level']:.4g}, 99 % {row['p99_to_level']:.4g}, max {row['max_to_level']:.4g}; "
                  f"{row['within']:.1%} within, worst {row['ratio_to_finest']:.3g} and {row['ratio_to_level']:.3g} times")
    if options.json:
        print(json.dumps({"levels": levels, "breaches": breaches}))
    else:
        for text in breaches[:20]:
            print(f"  {text}")
    return 1 if breaches else 0


if __name__ == "__main__":
    sys.exit(main())
