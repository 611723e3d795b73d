"""VTK's older files by VTK."""

import os

from volume import Case, Found, Unreadable, head_of

from .vti import cases_of

ours = "vtk"
needs = {"vtkmodules": "python3-vtk9"}


def find(path):
    if not os.path.isfile(path) or not head_of(path, 22).startswith(b"# vtk DataFile"):
        return None
    from vtkmodules.vtkCommonCore import vtkObject
    from vtkmodules.vtkCommonDataModel import vtkImageData
    from vtkmodules.vtkIOLegacy import vtkGenericDataObjectReader

    vtkObject.GlobalWarningDisplayOff()
    reader = vtkGenericDataObjectReader()
    reader.SetFileName(path)
    reader.ReadAllScalarsOn()
    reader.Update()
    image = reader.GetOutput()
    if image is None:
        def fail():
            raise Unreadable("VTK: cannot read it")
        return Found([Case(path, fail)])
    if not isinstance(image, vtkImageData):
        return Found([Case(path, refused="no image but a " + image.GetClassName())])
    return Found(cases_of(path, image))
