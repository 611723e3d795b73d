"""By VTK's writers."""

import os

import numpy as np

from .samples import TYPES, rotation, smooth, volume


def image_of(arrays, cells=None, turn=None, low=(0, 0, 0)):
    """arrays: by name, [z, y, x] or [z, y, x, values]; the first are the scalars."""
    from vtkmodules.util.numpy_support import numpy_to_vtk
    from vtkmodules.vtkCommonDataModel import vtkImageData

    image = vtkImageData()
    first = next(iter(arrays.values())) if arrays else None
    size = first.shape[2::-1] if arrays else tuple(n + 1 for n in next(iter(cells.values())).shape[::-1])
    image.SetExtent(*[v for a, n in zip(low, size) for v in (a, a + n - 1)])
    image.SetSpacing(0.5, 1.25, 3)
    image.SetOrigin(-4, 5, 6.5)
    if turn is not None:
        image.SetDirectionMatrix([float(n) for n in turn.ravel()])
    for data, named in ((image.GetPointData(), arrays), (image.GetCellData(), cells or {})):
        for name, samples in named.items():
            values = samples.shape[3] if samples.ndim > 3 else 1
            array = numpy_to_vtk(samples.reshape(-1, values) if values > 1 else samples.ravel(), deep=True)
            array.SetName(name)
            data.AddArray(array)
    return image


def save(path, image, mode="raw", compressor="none", big=False, long_sizes=True, active=None):
    from vtkmodules.vtkIOXML import vtkXMLImageDataWriter

    if active:
        image.GetPointData().SetActiveScalars(active)
    writer = vtkXMLImageDataWriter()
    writer.SetFileName(path)
    writer.SetInputData(image)
    {"ascii": writer.SetDataModeToAscii, "binary": writer.SetDataModeToBinary}.get(
        mode, writer.SetDataModeToAppended)()
    writer.SetEncodeAppendedData(mode == "base64")
    writer.SetCompressorType({"none": 0, "zlib": 1, "lz4": 2, "lzma": 3}[compressor])
    (writer.SetByteOrderToBigEndian if big else writer.SetByteOrderToLittleEndian)()
    (writer.SetHeaderTypeToUInt64 if long_sizes else writer.SetHeaderTypeToUInt32)()
    writer.Write()


def write(folder):
    def at(name):
        return os.path.join(folder, name + ".vti")

    for dtype in TYPES:
        save(at(dtype), image_of({"a": volume(dtype)}))
        save(at(dtype + "_big"), image_of({"a": volume(dtype)}), big=True)
        # Text has no NaNs.
        samples = np.nan_to_num(volume(dtype), posinf=1, neginf=-1) if dtype[0] == "f" else volume(dtype)
        save(at(dtype + "_ascii"), image_of({"a": samples}), "ascii")
    scan = image_of({"a": smooth("u2", (90, 70, 10))})
    for mode in ("raw", "base64", "binary"):
        for compressor in ("none", "zlib", "lz4", "lzma"):
            for long_sizes in (True, False):
                name = f"{mode}_{compressor}_{64 if long_sizes else 32}"
                save(at(name), scan, mode, compressor, long_sizes=long_sizes)
    save(at("turned"), image_of({"a": volume("i2")}, turn=rotation(30, 20)))
    save(at("turned_extent"), image_of({"a": volume("i2")}, turn=rotation(30, 20), low=(-2, 5, 100)))
    save(at("extent"), image_of({"a": volume("i2")}, low=(-2, 5, 100)))
    save(at("two"), image_of({"a": volume("i2"), "b": volume("f4")}))
    save(at("two_active"), image_of({"a": volume("i2"), "b": volume("f4")}), active="b")
    save(at("cells"), image_of({}, {"c": volume("i2")}))
    save(at("vectors"), image_of({"v": volume("f4", (12, 5, 7)).reshape(7, 5, 4, 3)}))
