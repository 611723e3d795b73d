"""VTK's XML images by VTK."""

import os

import numpy as np

from volume import Case, Found, Unreadable, Volume, affine_of

ours = "vti"
needs = {"vtkmodules": "python3-vtk9"}


def arrays_of(data):
    return [data.GetArrayName(i) for i in range(data.GetNumberOfArrays())]


def volume_of(image, name, cells):
    """An array as a volume; of cells the centres of these are its places."""
    from vtkmodules.util.numpy_support import vtk_to_numpy

    data = image.GetCellData() if cells else image.GetPointData()
    scalars = data.GetArray(name)
    size = [n - cells for n in image.GetDimensions()]
    turn = image.GetDirectionMatrix()
    direction = np.array([[turn.GetElement(i, j) for j in range(3)] for i in range(3)])
    spacing = np.array(image.GetSpacing())
    # The first sample: extents need not begin at 0.
    low = np.array(image.GetExtent()[::2], float) + (0.5 if cells else 0)
    origin = np.array(image.GetOrigin()) + direction @ (low * spacing)
    affine = affine_of((direction * spacing).T, origin)
    samples = vtk_to_numpy(scalars).reshape(size[::-1])
    return Volume(samples, tuple(np.abs(spacing)), affine)


def cases_of(path, image):
    """Chosen by itself: the active scalars, else the only array."""
    points, cells = image.GetPointData(), image.GetCellData()
    names = [(n, False) for n in arrays_of(points)] + [(n, True) for n in arrays_of(cells)]

    def case(name, of_cells, arguments):
        data = cells if of_cells else points
        count = data.GetArray(name).GetNumberOfComponents()
        if count > 1:
            return Case(path, None, arguments, f"{count} values a sample")
        return Case(path, lambda: volume_of(image, name, of_cells), arguments)

    if not names:
        return [Case(path, refused="no array")]
    active = points.GetScalars() or (cells.GetScalars() if not arrays_of(points) else None)
    if len(names) == 1:
        return [case(*names[0], [])]
    cases = [case(active.GetName(), points.GetScalars() is None, [])] if active else [
        Case(path, refused=f"{len(names)} arrays and no choice")]
    return cases + [case(name, of_cells, ["--dataset", name]) for name, of_cells in names]


def find(path):
    if not os.path.isfile(path) or not path.lower().endswith((".vti", ".pvti")):
        return None
    if path.lower().endswith(".pvti"):
        return Found([Case(path, refused="names its parts, which are files of their own")])
    from vtkmodules.vtkCommonCore import vtkObject
    from vtkmodules.vtkIOXML import vtkXMLImageDataReader

    vtkObject.GlobalWarningDisplayOff()
    reader = vtkXMLImageDataReader()
    reader.SetFileName(path)
    reader.Update()
    image = reader.GetOutput()
    if image.GetNumberOfPoints() == 0:
        def fail():
            raise Unreadable("VTK: no image")
        return Found([Case(path, fail)])
    return Found(cases_of(path, image))
