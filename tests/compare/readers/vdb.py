"""OpenVDB by its own library from Python: the box of active voxels and one voxel more on each side,
which closes a surface."""

import os

import numpy as np

from volume import Case, Found, Unreadable, Volume, affine_of, head_of, steps_length

ours = "vdb"
needs = {"pyopenvdb": "python3-openvdb"}

TYPES = {"float": "f4", "double": "f8", "int32": "i4", "int64": "i8", "bool": "?"}


def load(path, name):
    import pyopenvdb

    grid = pyopenvdb.read(path, name)
    low, high = (np.array(c) for c in grid.evalActiveVoxelBoundingBox())
    if (high < low).any():
        raise Unreadable("no active voxel")
    low, high = low - 1, high + 1
    kind = TYPES.get(grid.valueTypeName, "f4")
    samples = np.zeros(high - low + 1, kind)
    grid.copyToArray(samples, ijk=tuple(int(n) for n in low))
    samples = np.ascontiguousarray(samples.transpose())
    if kind == "?":
        samples = samples.astype("u1")
    zero = np.array(grid.transform.indexToWorld((0.0, 0.0, 0.0)))
    steps = [np.array(grid.transform.indexToWorld(tuple(np.eye(3)[a]))) - zero for a in range(3)]
    origin = np.array(grid.transform.indexToWorld(tuple(float(n) for n in low)))
    affine = affine_of(steps, origin)
    return Volume(samples, steps_length(affine), affine)


def find(path):
    if not os.path.isfile(path) or head_of(path, 4) != b" BDV":
        return None
    import pyopenvdb

    try:
        grids = pyopenvdb.readAllGridMetadata(path)
    except Exception as error:  # pylint: disable=broad-except
        text = str(error)

        def fail():
            raise Unreadable("OpenVDB: " + text)
        return Found([Case(path, fail)])
    cases = []
    for grid in grids:
        arguments = ["--dataset", grid.name] if len(grids) > 1 else []
        if grid.valueTypeName not in TYPES:
            cases.append(Case(path, None, arguments, "values of " + grid.valueTypeName))
        else:
            cases.append(Case(path, lambda n=grid.name: load(path, n), arguments))
    if len(grids) != 1:
        cases.append(Case(path, refused=f"{len(grids)} grids and no choice"))
    return Found(cases)
