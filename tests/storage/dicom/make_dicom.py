"""Writes DICOM files by pydicom and what has to be read from them.

Usage: make_dicom.py made OUT          files of its own, one folder a case
       make_dicom.py real OUT PATH...  the expectations for files and folders that are there

A case NAME is the file or folder OUT/NAME (made), NAME.raw (samples, x fastest, little endian) and
NAME.txt: the path; the three sizes; the type; slope and intercept; then lines "i j k X Y Z", the
world of some samples. Exits with 77 where pydicom or what it needs is missing.
"""
import os
import subprocess
import sys

try:
    import numpy as np
    import pydicom
    from pydicom.dataset import Dataset, FileDataset, FileMetaDataset
    from pydicom.sequence import Sequence
    from pydicom.uid import (DeflatedExplicitVRLittleEndian, ExplicitVRBigEndian,
                             ExplicitVRLittleEndian, ImplicitVRLittleEndian, RLELossless)
except ImportError as missing:
    print(missing)
    sys.exit(77)

out = sys.argv[2]


def expect(name, path, array, worlds, scale=(1, 0)):
    """array: z, y, x; worlds: pairs of an index (i, j, k) and its place, or none."""
    array.astype(array.dtype.newbyteorder("<")).tofile(f"{out}/{name}.raw")
    with open(f"{out}/{name}.txt", "w") as file:
        z, y, x = array.shape
        print(path, file=file)
        print(x, y, z, array.dtype.name, *scale, file=file)
        for index, place in worlds:
            print(*index, *(f"{v:.6f}" for v in place), file=file)


def corners(position, orientation, spacing, rows, columns, k):
    """The world of the four corners of a slice, as PS3.3 C.7.6.2.1.1 has it."""
    position, orientation = np.array(position, float), np.array(orientation, float)
    row_spacing, column_spacing = (float(v) for v in spacing)
    for i in (0, columns - 1):
        for j in (0, rows - 1):
            yield (i, j, k), (position + orientation[:3] * column_spacing * i +
                              orientation[3:] * row_spacing * j)


def base(array, syntax, uid="1.2.826.0.1.99"):
    """A data set of one slice (y, x) or several frames (z, y, x)."""
    meta = FileMetaDataset()
    meta.MediaStorageSOPClassUID = pydicom.uid.CTImageStorage
    meta.MediaStorageSOPInstanceUID = pydicom.uid.generate_uid()
    meta.TransferSyntaxUID = syntax
    ds = FileDataset(None, {}, file_meta=meta, preamble=b"\0" * 128)
    ds.is_little_endian = syntax != ExplicitVRBigEndian
    ds.is_implicit_VR = syntax == ImplicitVRLittleEndian
    ds.SOPClassUID = meta.MediaStorageSOPClassUID
    ds.SOPInstanceUID = meta.MediaStorageSOPInstanceUID
    ds.ImageType = ["ORIGINAL", "PRIMARY", "AXIAL"]
    ds.Modality = "CT"
    ds.SeriesInstanceUID = uid
    ds.SeriesNumber = 4
    ds.SeriesDescription = "made"
    ds.PatientName = "Ünï^Cödé"
    ds.SpecificCharacterSet = "ISO_IR 100"
    ds.Rows, ds.Columns = array.shape[-2:]
    ds.SamplesPerPixel = 1
    ds.PhotometricInterpretation = "MONOCHROME2"
    ds.BitsAllocated = 8 * array.dtype.itemsize
    ds.BitsStored = ds.BitsAllocated
    ds.HighBit = ds.BitsStored - 1
    ds.PixelRepresentation = 1 if array.dtype.kind == "i" else 0
    ds.PixelSpacing = ["0.7", "0.4"]  # of rows, of columns
    ds.RescaleSlope = "2"
    ds.RescaleIntercept = "-1000"
    stored = array.astype(array.dtype.newbyteorder("<" if ds.is_little_endian else ">"))
    ds.PixelData = stored.tobytes()
    ds["PixelData"].VR = "OB" if array.dtype.itemsize == 1 else "OW"
    return ds


def volume(dtype, shape=(5, 6, 8), low=None, high=None):
    info = np.iinfo(dtype)
    random = np.random.default_rng(5)
    return random.integers(info.min if low is None else low, info.max if high is None else high,
                           shape, dtype, endpoint=True)


def smooth(dtype, scale, shape=(3, 40, 48)):
    """What lossless codecs and all others like better than noise."""
    z, y, x = np.meshgrid(*(np.arange(n) for n in shape), indexing="ij")
    return (scale * (1 + np.sin(0.2 * x + 0.1 * y + z)) + y).astype(dtype)


ORIENTATION = [0.8, 0.6, 0, 0, 0, -1]
NORMAL = np.cross(ORIENTATION[:3], ORIENTATION[3:])


def series(name, array, syntax=ExplicitVRLittleEndian, step=2.5 * NORMAL, change=None, finish=None):
    folder = f"{out}/{name}"
    os.makedirs(folder)
    worlds = []
    for k in range(len(array)):
        ds = base(array[k], syntax)
        position = np.round(np.array([10, -20, 30]) + k * step, 6)
        ds.ImagePositionPatient = [f"{v:.6f}" for v in position]
        ds.ImageOrientationPatient = ORIENTATION
        ds.InstanceNumber = (k * 3) % 7
        if change:
            change(ds, k)
        path = f"{folder}/{(k * 7) % 11:02}.ima"
        if syntax == RLELossless:
            ds.file_meta.TransferSyntaxUID = ExplicitVRLittleEndian
            ds.compress(RLELossless)
        ds.save_as(path, write_like_original=False)
        if finish:
            finish(path)
        worlds += corners(position, ORIENTATION, ds.PixelSpacing, ds.Rows, ds.Columns, k)
    expect(name, folder, array, worlds, (2, -1000))


def enhanced(name, array, order):
    ds = base(array[order], ExplicitVRLittleEndian)
    ds.NumberOfFrames = len(array)
    del ds.PixelSpacing, ds.RescaleSlope, ds.RescaleIntercept

    def item(**values):
        inner = Dataset()
        for key, value in values.items():
            setattr(inner, key, value)
        return inner

    shared = item(
        PixelMeasuresSequence=Sequence([item(PixelSpacing=["0.7", "0.4"], SliceThickness="9")]),
        PlaneOrientationSequence=Sequence([item(ImageOrientationPatient=ORIENTATION)]),
        PixelValueTransformationSequence=Sequence(
            [item(RescaleSlope="2", RescaleIntercept="-1000", RescaleType="HU")]))
    ds.SharedFunctionalGroupsSequence = Sequence([shared])
    frames, worlds = [], []
    for k in order:
        position = np.array([10, -20, 30]) + k * 2.5 * NORMAL
        frames.append(item(
            PlanePositionSequence=Sequence(
                [item(ImagePositionPatient=[f"{v:.6f}" for v in position])]),
            FrameContentSequence=Sequence([item(StackID="1", InStackPositionNumber=int(k) + 1)])))
        worlds += corners(position, ORIENTATION, (0.7, 0.4), ds.Rows, ds.Columns, k)
    ds.PerFrameFunctionalGroupsSequence = Sequence(frames)
    path = f"{out}/{name}.dcm"
    ds.save_as(path, write_like_original=False)
    # Once more with sequences of no stated length.
    for sequence in (ds.SharedFunctionalGroupsSequence, ds.PerFrameFunctionalGroupsSequence):
        sequence.is_undefined_length = True
    expect(name, path, array, worlds, (2, -1000))
    ds["SharedFunctionalGroupsSequence"].is_undefined_length = True
    ds["PerFrameFunctionalGroupsSequence"].is_undefined_length = True
    for frame in frames:
        frame.is_undefined_length_sequence_item = True
    path = f"{out}/{name}_open.dcm"
    ds.save_as(path, write_like_original=False)
    expect(f"{name}_open", path, array, worlds, (2, -1000))


def dose(name, array):
    """Frames at distances from the first, which need not be even in other files."""
    ds = base(array, ExplicitVRLittleEndian)
    del ds.RescaleSlope, ds.RescaleIntercept
    ds.Modality = "RTDOSE"
    ds.NumberOfFrames = len(array)
    ds.ImagePositionPatient = ["10", "-20", "30"]
    ds.ImageOrientationPatient = ORIENTATION
    ds.DoseGridScaling = "0.001"
    ds.GridFrameOffsetVector = [str(1.5 * k) for k in range(len(array))]
    worlds = []
    for k in range(len(array)):
        worlds += corners(np.array([10, -20, 30]) + 1.5 * k * NORMAL, ORIENTATION, (0.7, 0.4),
                          ds.Rows, ds.Columns, k)
    ds.save_as(f"{out}/{name}.dcm", write_like_original=False)
    expect(name, f"{out}/{name}.dcm", array, worlds, (0.001, 0))


def by_tool(*command):
    def finish(path):
        subprocess.run([*command, path, path + ".x"], check=True, capture_output=True)
        os.replace(path + ".x", path)
    return finish


def by_gdcm(*options):
    """Compresses in place by GDCM's own writer."""
    import gdcm

    def finish(path):
        reader = gdcm.ImageReader()
        reader.SetFileName(path)
        assert reader.Read()
        change = gdcm.ImageChangeTransferSyntax()
        change.SetTransferSyntax(gdcm.TransferSyntax(*options))
        change.SetInput(reader.GetImage())
        assert change.Change()
        writer = gdcm.ImageWriter()
        writer.SetFile(reader.GetFile())
        writer.SetFileName(path)
        writer.SetImage(change.GetOutput())
        assert writer.Write()
    return finish


def twelve_bits(ds, _):
    ds.BitsStored, ds.HighBit = 12, 11


def made():
    for dtype in ("uint8", "int8", "uint16", "int16", "uint32", "int32"):
        series(f"little_{dtype}", volume(dtype))
    series("implicit", volume("int16"), ImplicitVRLittleEndian)
    series("big", volume("int16"), ExplicitVRBigEndian)
    series("deflated", volume("uint16"), DeflatedExplicitVRLittleEndian)
    series("tilted", volume("int16"), step=2.5 * NORMAL + np.array([0, 0, 0.9]))

    def signed_12(ds, k):
        # The upper bits of a sample hold something else.
        words = np.frombuffer(ds.PixelData, "<u2")
        ds.PixelData = ((words & 0xfff) | (0x1000 * (k + 3) & 0xf000)).astype("<u2").tobytes()
        twelve_bits(ds, k)
    series("signed_12", volume("int16", low=-2048, high=2047), change=signed_12)
    for dtype in ("uint8", "uint16"):
        series(f"rle_{dtype}", volume(dtype), RLELossless)
    series("rle_smooth", smooth("uint16", 900), RLELossless)
    enhanced("enhanced", volume("int16"), np.array([3, 0, 4, 1, 2]))

    dose("dose", volume("uint32"))

    def padded(ds, _):
        ds.PixelPaddingValue = -2000
        ds["PixelPaddingValue"].VR = "SS"
    series("padded", volume("int16"), change=padded)
    for name, options in {"sv1": ["+e1"], "lossless": ["+el"]}.items():
        series(f"jpeg_{name}_12", smooth("uint16", 1900), change=twelve_bits,
               finish=by_tool("dcmcjpeg", *options))
        series(f"jpeg_{name}_16", smooth("uint16", 30000), finish=by_tool("dcmcjpeg", *options))
        series(f"jpeg_{name}_8", smooth("uint8", 100), finish=by_tool("dcmcjpeg", *options))
    series("jpeg_ls_16", smooth("uint16", 30000), finish=by_tool("dcmcjpls"))
    series("jpeg_ls_signed", smooth("int16", 15000) - 15000, finish=by_tool("dcmcjpls"))
    series("jpeg_ls_8", smooth("uint8", 100), finish=by_tool("dcmcjpls"))
    for dtype in ("int16", "uint32", "int32"):
        series(f"tool_rle_{dtype}", volume(dtype), finish=by_tool("dcmcrle"))
    try:
        import gdcm
    except ImportError:
        return
    kind = gdcm.TransferSyntax.JPEG2000Lossless
    series("jpeg_2000_16", smooth("uint16", 30000), finish=by_gdcm(kind))
    series("jpeg_2000_signed", smooth("int16", 15000) - 15000, finish=by_gdcm(kind))
    series("jpeg_2000_8", smooth("uint8", 100), finish=by_gdcm(kind))


def gdcm_samples(path):
    """All frames of a file as GDCM decodes them: z, y, x."""
    import gdcm
    reader = gdcm.ImageReader()
    reader.SetFileName(path)
    assert reader.Read(), path
    image = reader.GetImage()
    pixels = image.GetPixelFormat()
    kind = ("i" if pixels.GetPixelRepresentation() else "u") + str(pixels.GetBitsAllocated() // 8)
    size = [image.GetDimension(i) for i in range(image.GetNumberOfDimensions())]
    data = image.GetBuffer().encode("utf-8", errors="surrogateescape")
    return np.frombuffer(data, "<" + kind).reshape(*reversed(size + [1] * (3 - len(size))))


def scale_of(ds):
    return float(ds.get("RescaleSlope", 1)), float(ds.get("RescaleIntercept", 0))


def real(paths):
    for number, path in enumerate(paths):
        files = [path]
        if os.path.isdir(path):
            files = sorted(os.path.join(path, name) for name in os.listdir(path))
        slices = []
        for file in files:
            ds = pydicom.dcmread(file, force=True)
            if "PixelData" in ds:
                slices.append((ds, file))
        placed = "ImagePositionPatient" in slices[0][0]
        if placed:
            normal = np.cross(*np.array(slices[0][0].ImageOrientationPatient, float).reshape(2, 3))
            slices.sort(key=lambda s: np.array(s[0].ImagePositionPatient, float) @ normal)
        array = np.concatenate([gdcm_samples(file) for _, file in slices])
        worlds = []
        if placed:
            for k, (ds, _) in enumerate(slices):
                worlds += corners(ds.ImagePositionPatient, ds.ImageOrientationPatient,
                                  ds.PixelSpacing, ds.Rows, ds.Columns, k)
        expect(f"real{number}", path, array, worlds, scale_of(slices[0][0]))


if sys.argv[1] == "made":
    made()
else:
    real(sys.argv[3:])
