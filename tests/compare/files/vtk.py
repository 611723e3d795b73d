"""VTK's older files by VTK's writer."""

import os

import numpy as np

from .samples import TYPES, volume
from .vti import image_of


def write(folder):
    from vtkmodules.vtkCommonDataModel import vtkPolyData
    from vtkmodules.vtkIOLegacy import vtkPolyDataWriter, vtkStructuredPointsWriter

    def save(name, image, text, active="a"):
        writer = vtkStructuredPointsWriter()
        writer.SetFileName(os.path.join(folder, name + ".vtk"))
        if active:
            image.GetPointData().SetActiveScalars(active)
        writer.SetInputData(image)
        (writer.SetFileTypeToASCII if text else writer.SetFileTypeToBinary)()
        writer.Write()

    for dtype in TYPES:
        samples = np.nan_to_num(volume(dtype), posinf=1, neginf=-1) if dtype[0] == "f" else volume(dtype)
        save(dtype, image_of({"a": volume(dtype)}), False)
        save(dtype + "_ascii", image_of({"a": samples}), True)
    save("two", image_of({"a": volume("i2"), "b": volume("f4")}), False, None)
    save("cells", image_of({}, {"c": volume("i2")}), False, None)
    save("vectors", image_of({"a": volume("f4", (12, 5, 7)).reshape(7, 5, 4, 3)}), False)
    writer = vtkPolyDataWriter()
    writer.SetFileName(os.path.join(folder, "surface.vtk"))
    writer.SetInputData(vtkPolyData())
    writer.Write()
