"""By OpenVDB's own library from Python."""

import os

import numpy as np
import pyopenvdb

from .samples import rotation, volume


def write(folder):
    def at(name):
        return os.path.join(folder, name + ".vdb")

    def grid_of(kind, samples, name, place=(0, 0, 0), **settings):
        grid = kind(**settings)
        grid.copyFromArray(np.ascontiguousarray(samples.T), ijk=place)
        grid.name = name
        return grid

    finite = np.nan_to_num(volume("f4", (20, 15, 12)), posinf=1, neginf=-1)
    fog = grid_of(pyopenvdb.FloatGrid, finite, "density", (-5, 3, 100))
    pyopenvdb.write(at("fog"), grids=[fog])
    moved = fog.deepCopy()
    matrix = np.eye(4)
    matrix[:3, :3], matrix[3, :3] = (rotation(30, 20) * [0.5, 1.25, 3]).T, [10, 20, 30]
    moved.transform = pyopenvdb.createLinearTransform([list(row) for row in matrix])
    pyopenvdb.write(at("turned"), grids=[moved])
    ball = pyopenvdb.createLevelSetSphere(radius=6.0, center=(1.0, 2.0, 3.0), voxelSize=0.5)
    ball.name = "surface"
    pyopenvdb.write(at("sphere"), grids=[ball])
    pyopenvdb.write(at("two"), grids=[fog, ball])
    if hasattr(pyopenvdb, "Int32Grid"):
        pyopenvdb.write(at("int32"), grids=[grid_of(pyopenvdb.Int32Grid, volume("i4"), "labels")])
    pyopenvdb.write(at("bool"), grids=[grid_of(pyopenvdb.BoolGrid, volume("i2") > 0, "mask")])
    half = fog.deepCopy()
    half.saveFloatAsHalf = True
    pyopenvdb.write(at("half"), grids=[half])
    empty = pyopenvdb.FloatGrid()
    empty.name = "empty"
    pyopenvdb.write(at("empty"), grids=[empty])
    vectors = pyopenvdb.Vec3SGrid()
    vectors.name = "velocity"
    vectors.fill((0, 0, 0), (3, 3, 3), (1.0, 2.0, 3.0))
    pyopenvdb.write(at("vectors"), grids=[vectors])
