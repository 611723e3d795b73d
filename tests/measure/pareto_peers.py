#!/usr/bin/python3
"""Meshes of a volume by other programs, for pareto.py.

usage: pareto_peers.py probe PROGRAM
       pareto_peers.py PROGRAM INPUT OUTPUT.ply SETTING

PROGRAM and INPUT: openvdb (a volume; SETTING is the adaptivity), flying_edges (a volume; SETTING is
not used), fine (a volume; SETTING is how many samples a side of its middle are taken: the mesh by
which others are measured) or vtk_quadric (a mesh; SETTING is the share of triangles to keep).
Volumes are NRRD files as pareto.py writes them: with their isovalue and side of the material in
comments. Meshes are in sample indices. Prints the seconds that the program itself took, from
samples or triangles in memory to triangles in memory. A probe ends with 77 where the library is
missing.
"""
import importlib
import re
import sys
import time

import numpy as np

LIBRARIES = {"openvdb": "pyopenvdb", "flying_edges": "vtk", "fine": "vtk", "vtk_quadric": "vtk"}
NOT_INSTALLED = 77


def read_volume(path):
    """Samples, z slowest, as floats that are negative inside, and where they are 0."""
    with open(path, "rb") as file:
        header = {}
        inside, isovalue = "below", None
        for line in iter(file.readline, b"\n"):
            text = line.decode().strip()
            if comment := re.match(r"# isovalue ([-\d.e]+), inside (\w+)", text):
                isovalue, inside = float(comment[1]), comment[2]
            elif field := re.match(r"([\w ]+): (.*)", text):
                header[field[1]] = field[2]
        kind = np.dtype(
            {"uint16": "<u2", "int16": "<i2", "uint8": "u1", "float": "<f4"}[header["type"]]
        )
        assert header["encoding"] == "raw" and header.get("endian", "little") == "little"
        shape = [int(n) for n in reversed(header["sizes"].split())]
        samples = np.fromfile(file, kind, count=int(np.prod(shape, dtype=np.int64))).reshape(shape)
    values = samples.astype(np.float32)
    values -= np.float32(isovalue)
    return values if inside == "below" else -values


def write_ply(path, points, triangles):
    faces = np.empty(len(triangles), [("corners", "u1"), ("corner", "<i4", 3)])
    faces["corners"] = 3
    faces["corner"] = triangles
    with open(path, "wb") as file:
        file.write(
            (
                "ply\nformat binary_little_endian 1.0\n"
                f"element vertex {len(points)}\n"
                "property float x\nproperty float y\nproperty float z\n"
                f"element face {len(triangles)}\n"
                "property list uchar int vertex_indices\nend_header\n"
            ).encode()
        )
        np.ascontiguousarray(points, "<f4").tofile(file)
        faces.tofile(file)


def openvdb(source, target, setting):
    import pyopenvdb

    values = read_volume(source)
    # What lies outside of the samples is outside of the material.
    grid = pyopenvdb.FloatGrid(float(values.max()))
    grid.copyFromArray(np.ascontiguousarray(values.transpose(2, 1, 0)))
    del values
    start = time.monotonic()
    points, triangles, quads = grid.convertToPolygons(isovalue=0, adaptivity=float(setting))
    seconds = time.monotonic() - start
    halves = [triangles, quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]] if len(quads) else [triangles]
    write_ply(target, points, np.concatenate([half.reshape(-1, 3) for half in halves]))
    return seconds


def write_poly_data(target, data):
    from vtk.util.numpy_support import vtk_to_numpy

    # Cells are numbers of corners with the corners.
    triangles = vtk_to_numpy(data.GetPolys().GetConnectivityArray()).reshape(-1, 3)
    write_ply(target, vtk_to_numpy(data.GetPoints().GetData()), triangles)


def contour(target, values, first=(0, 0, 0), spacing=1):
    """By FlyingEdges. first: the sample index of the first value, x first."""
    import vtk
    from vtk.util.numpy_support import numpy_to_vtk

    image = vtk.vtkImageData()
    image.SetDimensions(*reversed(values.shape))
    image.SetOrigin(*first)
    image.SetSpacing(spacing, spacing, spacing)
    image.GetPointData().SetScalars(numpy_to_vtk(values.reshape(-1)))
    edges = vtk.vtkFlyingEdges3D()
    edges.SetInputData(image)
    edges.SetValue(0, 0.0)
    edges.ComputeNormalsOff()
    edges.ComputeScalarsOff()
    start = time.monotonic()
    edges.Update()
    seconds = time.monotonic() - start
    write_poly_data(target, edges.GetOutput())
    return seconds


def flying_edges(source, target, _setting):
    return contour(target, read_volume(source))


def doubled(values, axis):
    """Between any two samples the value of the cubic through the four nearest."""
    samples = np.moveaxis(values, axis, 0)
    result = np.empty((2 * len(samples) - 1, *samples.shape[1:]), np.float32)
    result[::2] = samples
    around = np.concatenate([samples[:1], samples, samples[-1:]])
    result[1::2] = (9 * (samples[:-1] + samples[1:]) - around[:-3] - around[3:]) / 16
    return np.moveaxis(result, 0, axis)


def fine(source, target, side):
    values = read_volume(source)
    first = [max(n - int(side), 0) // 2 for n in values.shape]
    values = values[tuple(slice(at, at + int(side)) for at in first)]
    for axis in range(3):
        values = doubled(values, axis)
    return contour(target, np.ascontiguousarray(values), tuple(reversed(first)), 0.5)


def vtk_quadric(source, target, setting):
    import vtk

    reader = vtk.vtkPLYReader()
    reader.SetFileName(source)
    reader.Update()
    decimation = vtk.vtkQuadricDecimation()
    decimation.SetInputData(reader.GetOutput())
    decimation.SetTargetReduction(1 - float(setting))
    start = time.monotonic()
    decimation.Update()
    seconds = time.monotonic() - start
    write_poly_data(target, decimation.GetOutput())
    return seconds


def main(arguments):
    if len(arguments) == 2 and arguments[0] == "probe":
        return probe(arguments[1])
    if len(arguments) != 4 or arguments[0] not in LIBRARIES:
        print(__doc__, file=sys.stderr)
        return 2
    program, *rest = arguments
    programs = {
        "openvdb": openvdb,
        "flying_edges": flying_edges,
        "fine": fine,
        "vtk_quadric": vtk_quadric,
    }
    print(programs[program](*rest))
    return 0


def probe(name):
    try:
        importlib.import_module(LIBRARIES[name])
    except ImportError:
        return NOT_INSTALLED
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
