"""DICOM by pydicom, compressed samples by GDCM through it. Slices are put in order here, by their
position along the normal of the image plane."""

import os
import warnings

import numpy as np

from volume import Case, Found, Unreadable, Volume, affine_of, head_of

ours = "dicom"
needs = {"pydicom": "python3-pydicom", "gdcm": "python3-gdcm"}


def looks_dicom(path):
    if not os.path.isfile(path):
        return False
    head = head_of(path)
    return head[128:132] == b"DICM" or head[:2] in (b"\x08\x00", b"\x02\x00") and head[3:4] == b"\x00"


def read_slice(path, with_samples=False):
    import pydicom

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return pydicom.dcmread(path, force=True, stop_before_pixels=not with_samples)


def stored_samples(path):
    """As they are stored: neither scaled nor turned."""
    data = read_slice(path, True)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            return data, data.pixel_array
    except Exception as error:
        raise Unreadable(f"pydicom: {error}") from error


def plane_of(data):
    turn = [float(n) for n in data.ImageOrientationPatient]
    x, y = np.array(turn[:3]), np.array(turn[3:])
    return x, y, np.cross(x, y)


def scale_of(data):
    return float(data.get("RescaleSlope", 1)), float(data.get("RescaleIntercept", 0))


def series_in(paths):
    """Of images: by series and shape, as one volume can have them."""
    series = {}
    for path in sorted(paths):
        data = read_slice(path)
        if "Rows" not in data:
            continue
        turn = tuple(round(float(n), 4) for n in data.get("ImageOrientationPatient", []))
        key = (str(data.get("SeriesInstanceUID", "")), turn, data.Rows, data.Columns)
        series.setdefault(key, []).append((path, data))
    return series


def step_of(places, normal, thickness):
    """The world vector from slice to slice, where all are equally far apart."""
    if len(places) == 1:
        return normal * float(thickness or 1)
    step = (places[-1] - places[0]) / (len(places) - 1)
    gaps = np.diff([p @ normal for p in places])
    allowed = max(0.01, 0.01 * abs(step @ normal))
    if np.abs(gaps - step @ normal).max() > allowed:
        raise Unreadable("slices are not equally far apart: " + ", ".join(
            f"{gap:.4g}" for gap in sorted(set(np.round(gaps, 4)))[:6]))
    return step


def load_series(slices):
    first = slices[0][1]
    if "ImageOrientationPatient" not in first or "ImagePositionPatient" not in first:
        if len(slices) > 1:
            raise Unreadable("slices say no positions")
        data, samples = stored_samples(slices[0][0])
        rows, columns = (float(n) for n in data.get("PixelSpacing", (1, 1)))
        # One slice has no distance to another.
        volume = Volume(samples.reshape((-1,) + samples.shape[-2:]), (columns, rows, None))
        volume.slope, volume.intercept = scale_of(data)
        return volume
    x, y, normal = plane_of(first)
    slices = sorted(slices, key=lambda s: np.array(s[1].ImagePositionPatient, float) @ normal)
    places = [np.array(d.ImagePositionPatient, float) for _, d in slices]
    step = step_of(places, normal, first.get("SliceThickness"))
    rows, columns = (float(n) for n in first.PixelSpacing)
    scales = {scale_of(d) for _, d in slices}
    if len(scales) > 1:
        raise Unreadable("slices are scaled differently")
    samples = np.stack([stored_samples(path)[1] for path, _ in slices])
    affine = affine_of([x * columns, y * rows, step], places[0])
    spacing = (columns, rows, float(np.linalg.norm(step)) if len(slices) > 1 else None)
    slope, intercept = scales.pop()
    return Volume(samples, spacing, affine, "LPS", "mm", slope or 1.0, intercept)


def frame_groups(data, name):
    """Of an enhanced image: one item a frame, its own or the shared one."""
    shared = data.SharedFunctionalGroupsSequence[0]
    for frame in data.PerFrameFunctionalGroupsSequence:
        yield (frame if name in frame else shared)[name].value[0]


def load_enhanced(path):
    data, samples = stored_samples(path)
    x, y, normal = plane_of(next(frame_groups(data, "PlaneOrientationSequence")))
    places = [np.array(p.ImagePositionPatient, float)
              for p in frame_groups(data, "PlanePositionSequence")]
    measures = next(frame_groups(data, "PixelMeasuresSequence"))
    order = sorted(range(len(places)), key=lambda i: places[i] @ normal)
    places = [places[i] for i in order]
    step = step_of(places, normal, measures.get("SliceThickness"))
    rows, columns = (float(n) for n in measures.PixelSpacing)
    volume = Volume(samples.reshape((-1,) + samples.shape[-2:])[order],
                    (columns, rows, float(np.linalg.norm(step))),
                    affine_of([x * columns, y * rows, step], places[0]), "LPS", "mm")
    groups = list(data.SharedFunctionalGroupsSequence[0].get("PixelValueTransformationSequence", []))
    if groups:
        volume.slope, volume.intercept = scale_of(groups[0])
    return volume


def why_not(data):
    if int(data.get("SamplesPerPixel", 1)) != 1 or data.get("PhotometricInterpretation", "").startswith(
            ("PALETTE", "RGB", "YBR")):
        return "colours"
    return ""


def file_case(path):
    data = read_slice(path)
    if "Rows" not in data:
        return Case(path, refused="no image")
    if why_not(data):
        return Case(path, refused=why_not(data))
    if "PerFrameFunctionalGroupsSequence" in data:
        return Case(path, lambda: load_enhanced(path))
    return Case(path, lambda: load_series([(path, data)]))


def find(path):
    if os.path.isfile(path):
        return Found([file_case(path)]) if looks_dicom(path) else None
    names = [os.path.join(path, n) for n in sorted(os.listdir(path))]
    images = [n for n in names if looks_dicom(n)]
    if len(images) < 2 or len(images) < len([n for n in names if os.path.isfile(n)]) // 2:
        return None
    series = series_in(images)
    # Files of one transfer syntax each, and not slices of anything: each is a case by itself.
    if len(series) == len(images):
        return Found([file_case(n) for n in images], names)
    cases = []
    for (uid, *_), slices in series.items():
        arguments = ["--series", uid] if len(series) > 1 else []
        if len(series) == 1 or len([k for k in series if k[0] == uid]) == 1:
            cases.append(Case(path, lambda s=slices: load_series(s), arguments))
    if len(series) > 1:
        cases.append(Case(path, refused=f"{len(series)} series and no choice"))
    return Found(cases, images)
