"""N5 by zarr-python; what N5-Viewer and others say of scales is read here."""

import os

from volume import Case, Found, Unreadable, Volume, diagonal, native, read_json

ours = "n5"
needs = {"zarr": "python3-zarr"}


def described(folder):
    path = os.path.join(folder, "attributes.json")
    return read_json(path) if os.path.isfile(path) else {}


def resolution(folder):
    """Of an array itself: pixelResolution or resolution, x first."""
    found = described(folder)
    pixels = found.get("pixelResolution")
    unit = None
    if isinstance(pixels, dict):
        unit, pixels = pixels.get("unit"), pixels.get("dimensions")
    pixels = pixels or found.get("resolution")
    if not pixels or len(pixels) != 3:
        return None, None
    by = found.get("downsamplingFactors", [1, 1, 1])
    return tuple(float(p) * f for p, f in zip(pixels, by)), unit


def load(root, name):
    import zarr

    try:
        array = zarr.open_array(zarr.N5Store(root), path=name, mode="r")
        samples = native(array[...])
    except Exception as error:
        raise Unreadable(f"zarr-python: {error}") from error
    samples = samples.reshape((1,) * (3 - samples.ndim) + samples.shape)
    spacing, _ = resolution(os.path.join(root, name))
    return Volume(samples, spacing, diagonal(spacing, (0, 0, 0)) if spacing else None)


def case_of(root, folder):
    dimensions = described(folder)["dimensions"]
    if not 2 <= len(dimensions) <= 3:
        return Case(folder, refused=f"{len(dimensions)} dimensions")
    name = os.path.relpath(folder, root)
    if name == ".":
        root, name = os.path.split(os.path.abspath(folder))
    return Case(folder, lambda: load(root, name))


def find(path):
    if not os.path.isfile(os.path.join(path, "attributes.json")):
        return None
    cases = []
    for folder, folders, _ in os.walk(path):
        folders.sort()
        if "dimensions" in described(folder):
            cases.append(case_of(path, folder))
            folders.clear()
    if "dimensions" not in described(path) and len(cases) > 1:
        cases.append(Case(path, refused="a group, and no array of it is chosen"))
    return Found(cases)
