"""By pydicom: series in folders, and single files."""

import os

import numpy as np
from pydicom.dataset import Dataset, FileMetaDataset
from pydicom.sequence import Sequence
from pydicom.uid import ExplicitVRBigEndian, ExplicitVRLittleEndian, ImplicitVRLittleEndian, RLELossless

from .samples import rotation, volume

CT, ENHANCED = "1.2.840.10008.5.1.4.1.1.2", "1.2.840.10008.5.1.4.1.1.2.1"
ROOT = "1.2.826.0.1.3680043.10.999."


def plain(samples, syntax, series, number):
    """The parts that all have: samples are [y, x] or [z, y, x]."""
    data = Dataset()
    data.file_meta = FileMetaDataset()
    data.file_meta.TransferSyntaxUID = syntax
    data.file_meta.MediaStorageSOPClassUID = data.SOPClassUID = CT
    data.file_meta.MediaStorageSOPInstanceUID = data.SOPInstanceUID = f"{ROOT}{series}.{number}"
    data.is_little_endian = syntax != ExplicitVRBigEndian
    data.is_implicit_VR = syntax == ImplicitVRLittleEndian
    data.StudyInstanceUID, data.SeriesInstanceUID = ROOT + "1", f"{ROOT}{series}"
    data.SeriesNumber, data.InstanceNumber, data.Modality = series, number, "CT"
    data.PatientName, data.SeriesDescription = "Nobody", f"series {series}"
    data.Rows, data.Columns = samples.shape[-2:]
    bits = samples.dtype.itemsize * 8
    data.SamplesPerPixel, data.PhotometricInterpretation = 1, "MONOCHROME2"
    data.BitsAllocated, data.BitsStored, data.HighBit = bits, bits, bits - 1
    data.PixelRepresentation = int(samples.dtype.kind == "i")
    order = "<" if data.is_little_endian else ">"
    data.PixelData = samples.astype(samples.dtype.newbyteorder(order)).tobytes()
    data["PixelData"].VR = "OW"
    return data


def place(data, turn, position, spacing=(1.25, 0.5)):
    """spacing: rows apart, columns apart."""
    data.ImageOrientationPatient = [round(float(n), 12) for n in (*turn[:, 0], *turn[:, 1])]
    data.ImagePositionPatient = [round(float(n), 9) for n in position]
    data.PixelSpacing, data.SliceThickness = list(spacing), 9


def save(data, path):
    data.preamble = b"\0" * 128
    data.save_as(path, write_like_original=False)


def series(folder, samples, series_number=2, turn=np.eye(3), tilt=(0, 0, 0), places=None,
           syntax=ExplicitVRLittleEndian, scale=None, change=None):
    """Slices with shuffled names. places: along the normal, in mm."""
    os.makedirs(folder, exist_ok=True)
    places = np.arange(len(samples)) * 3.0 if places is None else places
    names = np.random.default_rng(5).permutation(len(samples))
    for z, image in enumerate(samples):
        rle = syntax == RLELossless
        data = plain(image, ExplicitVRLittleEndian if rle else syntax, series_number, z + 1)
        place(data, turn, np.array([-10.0, 20, 30]) + turn[:, 2] * places[z] + np.array(tilt) * z)
        if scale:
            data.RescaleSlope, data.RescaleIntercept = scale
        if change:
            change(data, z)
        if rle:
            data.compress(RLELossless)
        save(data, os.path.join(folder, f"{names[z]:03}_{series_number}"))


def enhanced(path, samples, turn):
    data = plain(samples, ExplicitVRLittleEndian, 9, 1)
    data.file_meta.MediaStorageSOPClassUID = data.SOPClassUID = ENHANCED
    data.NumberOfFrames = len(samples)
    shared, orientation, measures, scale = Dataset(), Dataset(), Dataset(), Dataset()
    orientation.ImageOrientationPatient = [round(float(n), 12) for n in (*turn[:, 0], *turn[:, 1])]
    measures.PixelSpacing, measures.SliceThickness = [1.25, 0.5], 9
    scale.RescaleSlope, scale.RescaleIntercept, scale.RescaleType = 2, -1024, "HU"
    shared.PlaneOrientationSequence = Sequence([orientation])
    shared.PixelMeasuresSequence = Sequence([measures])
    shared.PixelValueTransformationSequence = Sequence([scale])
    data.SharedFunctionalGroupsSequence = Sequence([shared])
    frames = []
    for z in range(len(samples)):
        frame, position = Dataset(), Dataset()
        # The last frame is the lowest.
        at = turn[:, 2] * 3.0 * (len(samples) - 1 - z)
        position.ImagePositionPatient = [round(float(n), 9) for n in at]
        frame.PlanePositionSequence = Sequence([position])
        frames.append(frame)
    data.PerFrameFunctionalGroupsSequence = Sequence(frames)
    save(data, path)


def write(folder):
    def at(name):
        return os.path.join(folder, name)

    size = (7, 6, 5)
    for dtype in ("u1", "i1", "u2", "i2", "u4", "i4"):
        series(at("type_" + dtype), volume(dtype, size))
    small = volume("i2", size)
    for name, syntax in (("implicit", ImplicitVRLittleEndian), ("big", ExplicitVRBigEndian),
                         ("rle", RLELossless)):
        series(at(name), small, syntax=syntax)
    series(at("turned"), small, turn=rotation(30, 20))
    series(at("tilted"), small, tilt=(0, 0.4, 0))
    series(at("scaled"), small, scale=(2, -1024))
    series(at("uneven"), small, places=[0, 3, 6, 9.5, 12])
    series(at("missing"), small, places=[0, 3, 9, 12, 15])
    series(at("scales_differ"), small, change=lambda d, z: (
        setattr(d, "RescaleSlope", 1 + z), setattr(d, "RescaleIntercept", 0)))
    twelve = (volume("i2", size) >> 4).astype("i2")

    def stored_12(data, _):
        data.BitsStored, data.HighBit = 12, 11

    series(at("bits_12"), twelve, change=stored_12)
    series(at("two_series"), small)
    series(at("two_series"), volume("u2", (9, 4, 3)), 3)
    os.makedirs(at("enhanced"), exist_ok=True)
    enhanced(at("enhanced/frames.dcm"), small, rotation(30, 20))
