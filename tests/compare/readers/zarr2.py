"""Zarr version 2 by zarr-python; axes, scales and units of OME-Zarr are read here."""

import os

import numpy as np

from volume import Case, Found, Unreadable, Volume, as_volume_axes, diagonal, native, read_json

ours = "zarr"
needs = {"zarr": "python3-zarr"}

UNITS = {"meter": "m", "centimeter": "cm", "millimeter": "mm", "micrometer": "um", "nanometer": "nm",
         "angstrom": "angstrom"}


def attributes(folder):
    """Of a group: those of version 2, or those of version 3, of OME-Zarr 0.5 one level down."""
    for name in (".zattrs", "zarr.json"):
        path = os.path.join(folder, name)
        if os.path.isfile(path):
            found = read_json(path)
            found = found.get("attributes", {}) if name == "zarr.json" else found
            return found.get("ome", found)
    return {}


def ome_of(array):
    """(axes, scale, translation, units) that a group above says of an array, or None."""
    folder = os.path.dirname(os.path.abspath(array))
    for _ in range(4):
        for image in attributes(folder).get("multiscales", []):
            for dataset in image.get("datasets", []):
                if os.path.normpath(os.path.join(folder, dataset["path"])) == os.path.abspath(array):
                    return transform(image, dataset)
        folder = os.path.dirname(folder)
    return None


def transform(image, dataset):
    axes = [a if isinstance(a, str) else a["name"] for a in image.get("axes", [])]
    units = ["" if isinstance(a, str) else UNITS.get(a.get("unit", ""), "") for a in image.get("axes", [])]
    scale = translation = None
    for holder in (dataset, image):
        for step in holder.get("coordinateTransformations", []):
            if step["type"] == "identity":
                continue
            by = np.array(step[step["type"]], float)
            scale = np.ones(len(by)) if scale is None else scale
            translation = np.zeros(len(by)) if translation is None else translation
            if step["type"] == "scale":
                scale, translation = scale * by, translation * by
            else:
                translation = translation + by
    return axes, scale, translation, units


def placed(samples, axes, ome):
    """A volume of an array whose axes have names, with what the group says of them."""
    if ome is not None and ome[0]:
        axes = ome[0]
    if not axes:
        axes = ["z", "y", "x"][3 - samples.ndim:]
    volume = Volume(native(as_volume_axes(samples, list(axes))))
    if ome is not None and ome[1] is not None and len(ome[1]) == len(axes):
        names = list(axes)
        at = [names.index(n) if n in names else None for n in "xyz"]
        volume.spacing = tuple(1.0 if i is None else float(ome[1][i]) for i in at)
        origin = [0.0 if i is None else float(ome[2][i]) for i in at]
        volume.affine = diagonal(volume.spacing, origin)
        units = {ome[3][i] for i in at if i is not None} if ome[3] else {""}
        volume.unit = units.pop() if len(units) == 1 else ""
    return volume


def why_not(array, axes):
    """Why no volume is to be had without a choice."""
    if array.ndim < 2:
        return f"{array.ndim} dimensions"
    if array.dtype.kind not in "iuf" and array.dtype.kind != "b":
        return f"samples of {array.dtype}"
    names = list(axes) or ["z", "y", "x"][-array.ndim:]
    extra = [n for n, size in zip(names, array.shape) if n not in "zyx" and size > 1]
    if extra:
        return "several of " + ", ".join(extra)
    return f"{array.ndim} dimensions" if array.ndim > 3 and not axes else ""


def array_cases(folder):
    import zarr

    try:
        array = zarr.open_array(folder, mode="r")
    except Exception as error:  # pylint: disable=broad-except
        text = str(error)

        def fail():
            raise Unreadable("zarr-python: " + text)

        return [Case(folder, fail)]
    ome = ome_of(folder)
    axes = ome[0] if ome else []
    why = why_not(array, axes)
    if not why:
        return [Case(folder, lambda: placed(array[...], axes, ome))]
    cases = [Case(folder, refused=why)]
    extra = [(i, n) for i, n in enumerate(axes) if n in ("c", "t") and array.shape[i] > 1]
    if extra and len(axes) == array.ndim:
        for last in (0, 1):
            index, arguments = [slice(None)] * array.ndim, []
            for i, name in extra:
                chosen = last * (array.shape[i] - 1)
                index[i] = slice(chosen, chosen + 1)
                arguments += ["--channel" if name == "c" else "--time", str(chosen)]
            cases.append(Case(folder, lambda k=tuple(index): placed(array[k], axes, ome), arguments))
    return cases


def only_array(group, mark, cases_of):
    """A group with one array stands for it; of several none is chosen."""
    arrays = [here for here, _, files in os.walk(group) if mark in files]
    if mark == "zarr.json":
        arrays = [a for a in arrays if read_json(os.path.join(a, mark)).get("node_type") == "array"]
    if len(arrays) != 1:
        return [Case(group, refused=f"a group of {len(arrays)} arrays and no choice")]
    return [Case(group, case.load, case.arguments, case.refused) for case in cases_of(arrays[0])]


def group_cases(folder, mark, cases_of):
    """Of an OME group: its full resolution, and a level. Of another group: no array is chosen."""
    images = attributes(folder).get("multiscales", [])
    if not images:
        return only_array(folder, mark, cases_of)
    paths = [os.path.join(folder, d["path"]) for d in images[0]["datasets"]]
    cases = []
    for level, path in [(None, paths[0])] + list(enumerate(paths))[1:2]:
        for case in cases_of(path):
            chosen = [] if level is None else ["--level", str(level)]
            cases.append(Case(folder, case.load, chosen + case.arguments, case.refused))
    return cases


def find(path):
    if path.endswith(".zarr.zip"):  # of one array, which zarr-python opens by that name
        return Found(array_cases(path))
    if not os.path.isdir(path):
        return None
    arrays, groups = [], []
    if os.path.isfile(os.path.join(path, ".zarray")):
        arrays = [path]
    elif os.path.isfile(os.path.join(path, ".zgroup")):
        for folder, folders, files in os.walk(path):
            folders.sort()
            if ".zarray" in files:
                arrays.append(folder)
                folders.clear()
            elif ".zgroup" in files:
                groups.append(folder)
    else:
        return None
    cases = [case for folder in groups for case in group_cases(folder, ".zarray", array_cases)]
    return Found(cases + [case for folder in arrays for case in array_cases(folder)])
