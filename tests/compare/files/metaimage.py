"""By VTK's writer, and headers by hand for what it does not write."""

import os

import numpy as np

from .samples import TYPES, rotation, volume

NAMES = {"u1": "MET_UCHAR", "i1": "MET_CHAR", "u2": "MET_USHORT", "i2": "MET_SHORT", "u4": "MET_UINT",
         "i4": "MET_INT", "u8": "MET_ULONG_LONG", "i8": "MET_LONG_LONG", "f4": "MET_FLOAT",
         "f8": "MET_DOUBLE"}


def by_vtk(path, samples, compressed):
    from vtkmodules.util.numpy_support import numpy_to_vtk
    from vtkmodules.vtkCommonDataModel import vtkImageData
    from vtkmodules.vtkIOImage import vtkMetaImageWriter

    image = vtkImageData()
    image.SetDimensions(samples.shape[::-1])
    image.SetSpacing(0.5, 1.25, 3)
    image.SetOrigin(-4, 5, 6.5)
    image.GetPointData().SetScalars(numpy_to_vtk(samples.ravel(), deep=True))
    writer = vtkMetaImageWriter()
    writer.SetFileName(path)
    writer.SetCompression(compressed)
    writer.SetInputData(image)
    writer.Write()


def by_hand(path, samples, fields=()):
    dims = samples.ndim
    head = ["ObjectType = Image", f"NDims = {dims}", "BinaryData = True",
            f"BinaryDataByteOrderMSB = {samples.dtype.str[0] == '>'}",
            "DimSize = " + " ".join(str(n) for n in samples.shape[::-1]),
            "ElementType = " + NAMES[samples.dtype.str[1:]], *fields, "ElementDataFile = LOCAL", ""]
    with open(path, "wb") as file:
        file.write("\n".join(head).encode() + samples.tobytes())


def write(folder):
    def at(name):
        return os.path.join(folder, name)

    for dtype in TYPES:
        samples = volume(dtype)
        # VTK's own names of 64-bit types are not the format's.
        if dtype not in ("u8", "i8"):
            by_vtk(at(dtype + ".mha"), samples, False)
            by_vtk(at(dtype + "_zlib.mha"), samples, True)
            by_vtk(at(dtype + ".mhd"), samples, False)
        for order in "<>":
            stored = samples.astype(np.dtype(dtype).newbyteorder(order))
            by_hand(at(f"{dtype}{'_big' if order == '>' else ''}_hand.mha"), stored,
                    ["ElementSpacing = 0.5 1.25 3"])
    small = volume("<i2")
    turn = " ".join("%.15g" % n for n in rotation(30, 20).T.ravel())
    by_hand(at("turned.mha"), small, ["ElementSpacing = 0.4 0.7 2.5", "TransformMatrix = " + turn,
                                      "Offset = -10.5 20 1000.25", "AnatomicalOrientation = RAI"])
    by_hand(at("flipped.mha"), small, ["ElementSpacing = 1 2 3", "Offset = 1 2 3",
                                       "TransformMatrix = -1 0 0 0 -1 0 0 0 1"])
    by_hand(at("scaled.mha"), small, ["ElementSpacing = 1 1 1", "ElementToIntensityFunctionSlope = 0.5",
                                      "ElementToIntensityFunctionOffset = -1024"])
    by_hand(at("one_time.mha"), small[np.newaxis], ["ElementSpacing = 1 2 3 1"])
    by_hand(at("times.mha"), volume("u1", (7, 5, 4, 3)), ["ElementSpacing = 1 2 3 1"])
    by_hand(at("vectors.mha"), small, ["ElementNumberOfChannels = 3"])
