#!/usr/bin/env python3
"""A level of detail made anew from a smaller volume, as tools do that mesh each scale of an image pyramid.

Usage: remeshed_level.py VOLUME.nrrd LEVEL ISOVALUE above|below OUT.ply    (.nhdr as well)

Means of 2^LEVEL samples a side, and vtkFlyingEdges3D of these: all triangles there are. Places are in the frame of the
volume: its spacing times the place of a sample, counted from the first. What lies beyond the volume is outside.
Exits 77 without VTK.
"""
import sys

try:
    import numpy as np
    from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
    from vtkmodules.vtkCommonDataModel import vtkImageData
    from vtkmodules.vtkFiltersCore import vtkFlyingEdges3D
    from vtkmodules.vtkIOImage import vtkNrrdReader
    from vtkmodules.vtkIOPLY import vtkPLYWriter
except ImportError as error:
    print(f"skipped: no VTK or no numpy for Python ({error}); Debian: python3-vtk9")
    sys.exit(77)


def read_volume(path):
    """Samples by z, y and x, and their distances by x, y and z."""
    reader = vtkNrrdReader()
    reader.SetFileName(path)
    reader.Update()
    image = reader.GetOutput()
    samples = vtk_to_numpy(image.GetPointData().GetScalars()).reshape(image.GetDimensions()[::-1])
    return samples, np.array(image.GetSpacing())


def smaller(samples, factor):
    """Means of blocks; the last ones are filled up with the samples at the border."""
    padded = np.pad(samples, [(0, -size % factor) for size in samples.shape], mode="edge")
    size = [n // factor for n in padded.shape]
    means = np.zeros(size)
    for z in range(factor):
        for y in range(factor):
            for x in range(factor):
                means += padded[z::factor, y::factor, x::factor]
    return (means / factor**3).astype(np.float32)


def surface(samples, spacing, factor, isovalue, outside):
    closed = np.pad(samples, 1, constant_values=outside)
    image = vtkImageData()
    image.SetDimensions(*closed.shape[::-1])
    image.SetSpacing(*(spacing * factor))
    # The centre of the first block, less the layer around.
    image.SetOrigin(*(spacing * ((factor - 1) / 2 - factor)))
    image.GetPointData().SetScalars(numpy_to_vtk(closed.ravel(), deep=True))
    edges = vtkFlyingEdges3D()
    edges.SetInputData(image)
    edges.SetValue(0, isovalue)
    edges.ComputeNormalsOff()
    edges.ComputeScalarsOff()
    edges.Update()
    return edges.GetOutput()


def main():
    path, level, isovalue, inside, out = sys.argv[1], int(sys.argv[2]), float(sys.argv[3]), *sys.argv[4:6]
    samples, spacing = read_volume(path)
    means = smaller(samples, 2**level)
    outside = float(means.min() if inside == "above" else means.max())
    writer = vtkPLYWriter()
    writer.SetInputData(surface(means, spacing, 2**level, isovalue, outside))
    writer.SetFileName(out)
    writer.SetFileTypeToBinary()
    writer.Write()


if __name__ == "__main__":
    sys.exit(main())
