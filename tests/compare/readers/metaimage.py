"""MetaImage by VTK. Its reader leaves the directions out: these are read here."""

import os
import re
import zlib

import numpy as np

from volume import Case, Found, Unreadable, Volume, affine_of, head_of, native

ours = "metaimage"
needs = {"vtkmodules": "python3-vtk9"}

TYPES = {"MET_UCHAR": "u1", "MET_CHAR": "i1", "MET_USHORT": "u2", "MET_SHORT": "i2", "MET_UINT": "u4",
         "MET_INT": "i4", "MET_ULONG_LONG": "u8", "MET_LONG_LONG": "i8", "MET_FLOAT": "f4",
         "MET_DOUBLE": "f8"}


def header_fields(path):
    text = head_of(path, 100_000).decode("latin-1")
    fields = {}
    for line in text.splitlines():
        match = re.match(r"\s*(\w+)\s*=\s*(.*?)\s*$", line)
        if not match:
            break
        fields[match.group(1)] = match.group(2)
        if match.group(1) == "ElementDataFile":
            break
    return fields, text


def numbers(text):
    return [float(n) for n in text.split()]


def behind_header(path, fields):
    """VTK reads no integers of 64 bits and no fourth dimension, and may crash: here samples are what
    ends the file."""
    order = ">" if fields.get("BinaryDataByteOrderMSB", "False") == "True" else "<"
    kind = np.dtype(order + TYPES[fields["ElementType"]])
    size = [int(n) for n in fields["DimSize"].split()[:3]]
    with open(path, "rb") as file:
        data = file.read()
    return np.frombuffer(data[-kind.itemsize * int(np.prod(size)) :], kind).reshape(size[::-1])


def inflated(path, fields, samples):
    """VTK takes CompressedDataSize at its word. Where the file is longer, all of it counts."""
    data = os.path.join(os.path.dirname(path), fields["ElementDataFile"])
    said = fields.get("CompressedDataSize")
    if said is None or not os.path.isfile(data) or os.path.getsize(data) == int(said):
        return samples
    with open(data, "rb") as file:
        plain = zlib.decompress(file.read())
    order = ">" if fields.get("BinaryDataByteOrderMSB", "False") == "True" else "<"
    return native(np.frombuffer(plain, samples.dtype.newbyteorder(order)).reshape(samples.shape))


def by_vtk(path):
    """Samples and spacing."""
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkCommonCore import vtkObject
    from vtkmodules.vtkIOImage import vtkMetaImageReader

    vtkObject.GlobalWarningDisplayOff()
    reader = vtkMetaImageReader()
    if not reader.CanReadFile(path):
        raise Unreadable("VTK: no MetaImage it can read")
    reader.SetFileName(path)
    reader.Update()
    image = reader.GetOutput()
    scalars = image.GetPointData().GetScalars()
    if scalars is None:
        raise Unreadable("VTK: no samples")
    return vtk_to_numpy(scalars).reshape(image.GetDimensions()[::-1]), image.GetSpacing()


def load(path, fields):
    beyond_vtk = "LONG_LONG" in fields["ElementType"] or int(fields["NDims"]) > 3
    if beyond_vtk and fields["ElementDataFile"] == "LOCAL":
        samples, spacing = native(behind_header(path, fields)), numbers(fields["ElementSpacing"])
    else:
        samples, spacing = by_vtk(path)
        samples = inflated(path, fields, samples)
    dims = int(fields["NDims"])
    matrix = np.eye(dims)
    for key in ("TransformMatrix", "Rotation", "Orientation"):
        if key in fields:
            matrix = np.array(numbers(fields[key])).reshape(dims, dims)
            break
    origin = next((numbers(fields[k]) for k in ("Offset", "Position", "Origin") if k in fields),
                  [0] * dims)
    spacing = [abs(s) for s in spacing[:3]]
    rows = [matrix[a][:3] / np.linalg.norm(matrix[a][:3]) * spacing[a] for a in range(3)]
    said = any(k in fields for k in ("TransformMatrix", "Rotation", "Orientation"))
    return Volume(
        samples, tuple(spacing),
        affine_of(rows, origin[:3]), space="LPS" if said else "",
        slope=float(fields.get("ElementToIntensityFunctionSlope", 1)) or 1.0,
        intercept=float(fields.get("ElementToIntensityFunctionOffset", 0)))


def part_files(path, fields, text):
    name = fields.get("ElementDataFile", "LOCAL")
    folder = os.path.dirname(path)
    if name.upper() == "LOCAL":
        return []
    if name.startswith("LIST"):
        names = [n.strip() for n in text[text.index("LIST"):].splitlines()[1:]]
    elif "%" in name:
        pattern, first, last, step = (name.split() + ["1"])[:4]
        names = [pattern % i for i in range(int(first), int(last) + 1, int(step))]
    else:
        names = [name]
    return [os.path.normpath(os.path.join(folder, n)) for n in names if n]


def find(path):
    if not os.path.isfile(path) or not path.lower().endswith((".mha", ".mhd")):
        return None
    fields, text = header_fields(path)
    case = Case(path, lambda: load(path, fields))
    if int(fields.get("ElementNumberOfChannels", 1)) > 1:
        case.refused = fields["ElementNumberOfChannels"] + " values a sample"
    elif any(int(n) > 1 for n in fields.get("DimSize", "").split()[3:]):
        case.refused = "a series of volumes"
    elif int(fields.get("NDims", 0)) < 3:
        case.refused = "2 dimensions"
    return Found([case], part_files(path, fields, text))
