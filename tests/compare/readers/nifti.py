"""NIfTI by nibabel."""

import os

import numpy as np

from volume import Case, Found, Volume

ours = "nifti"
needs = {"nibabel": "python3-nibabel"}

UNITS = {"meter": "m", "mm": "mm", "micron": "um", "unknown": ""}


def number(value, otherwise):
    return otherwise if value is None or not np.isfinite(value) else float(value)


def load(image, index):
    data = image.dataobj
    stored = np.asanyarray(data.get_unscaled() if hasattr(data, "get_unscaled") else data)
    stored = stored.reshape(tuple(stored.shape) + (1,) * max(0, 3 - stored.ndim))
    if index is None:
        stored = stored.reshape(stored.shape[:3])
    else:
        stored = stored.reshape(stored.shape[:3] + (-1,), order="F")[..., index]
    header = image.header
    slope, intercept = number(data.slope, 1.0), number(data.inter, 0.0)
    placed = int(header["sform_code"]) > 0 or int(header["qform_code"]) > 0
    zooms = tuple(float(z) if z > 0 and np.isfinite(z) else abs(float(z)) or 1.0
                  for z in list(header["pixdim"][1:4]))
    # Without a transform nibabel makes one up; the file has none.
    affine = image.affine if placed else None
    spacing = tuple(np.linalg.norm(affine[:3, :3], axis=0)) if placed else zooms
    return Volume(np.transpose(stored, (2, 1, 0)), spacing, affine, "RAS" if placed else "",
                  UNITS[header.get_xyzt_units()[0]], slope or 1.0, intercept if slope else 0.0)


def find(path):
    name = path.lower()
    if not os.path.isfile(path) or not name.endswith((".nii", ".nii.gz", ".hdr", ".hdr.gz")):
        return None
    import nibabel

    stem = path[: name.rindex(".hdr")] if ".hdr" in os.path.basename(name) else None
    parts = [stem + end for end in (".img", ".img.gz")] if stem else []
    image = nibabel.load(path)
    if not hasattr(image.header, "get_slope_inter") or "sform_code" not in image.header:
        return Found([Case(path, refused="no NIfTI but Analyze 7.5")], parts)
    if image.header.get_data_dtype().fields or image.header.get_data_dtype().kind == "c":
        return Found([Case(path, refused=f"samples of {image.header.get_data_dtype()}")], parts)
    count = int(np.prod(image.shape[3:])) if len(image.shape) > 3 else 1
    if count == 1:
        return Found([Case(path, lambda: load(image, None))], parts)
    cases = [Case(path, refused=f"{count} volumes and no choice")]
    for index in range(min(count, 3)):
        cases.append(Case(path, lambda i=index: load(nibabel.load(path), i), ["--time", str(index)]))
    return Found(cases, parts)
