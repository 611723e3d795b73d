"""HDF5 by h5py. What ilastik, Fiji, NeXus, Imaris and MINC say of axes and scales is read here."""

import json
import os

import numpy as np

from volume import Case, Found, Unreadable, Volume, affine_of, as_volume_axes, diagonal, head_of, native

ours = "hdf5"
needs = {"h5py": "python3-h5py"}

SIGNATURE = b"\x89HDF\r\n\x1a\n"


def text(value):
    """Imaris keeps texts as arrays of single characters."""
    if isinstance(value, np.ndarray):
        return b"".join(value.astype("S1").ravel().tolist()).decode()
    return value.decode() if isinstance(value, bytes) else str(value)


def axes_of(dataset):
    if "axistags" in dataset.attrs:
        return [a["key"] for a in json.loads(text(dataset.attrs["axistags"]))["axes"]]
    labels = [d.label for d in dataset.dims]
    if all(label in ("x", "y", "z", "c", "t") and label for label in labels):
        return labels
    return []


def candidates(file):
    """Numeric arrays with three dimensions of more than one sample."""
    found = []

    def look(name, thing):
        shape = getattr(thing, "shape", None)
        if shape is not None and thing.dtype.kind in "iufb" and sum(n > 1 for n in shape) >= 3:
            found.append(name)

    file.visititems(look)
    return found


def load(path, name, chosen):
    import h5py

    with h5py.File(path, "r") as file:
        dataset = file[name]
        try:
            array = dataset[...]
        except OSError as error:
            raise Unreadable(f"h5py: {error}") from error
        axes = axes_of(dataset)
        for axis, index in chosen.items():
            array = np.take(array, [index], axis=axes.index(axis))
        if not axes:
            while array.ndim > 3:
                array = array.squeeze(axis=array.shape.index(1))
            axes = ["z", "y", "x"]
        volume = Volume(native(as_volume_axes(array, axes)))
        if "element_size_um" in dataset.attrs:
            z, y, x = (float(n) for n in dataset.attrs["element_size_um"])
            volume.spacing, volume.unit = (x, y, z), "um"
        return volume


def load_imaris(path, level, chosen):
    import h5py

    with h5py.File(path, "r") as file:
        channel = file[f"DataSet/ResolutionLevel {level}/TimePoint {chosen['t']}/Channel {chosen['c']}"]
        size = [int(text(channel.attrs["ImageSize" + a])) for a in "ZYX"]
        samples = channel["Data"][: size[0], : size[1], : size[2]]
        image = file["DataSetInfo/Image"].attrs
        low = [float(text(image[f"ExtMin{a}"])) for a in range(3)]
        high = [float(text(image[f"ExtMax{a}"])) for a in range(3)]
        spacing = tuple((h - l) / n for l, h, n in zip(low, high, size[::-1]))
        # Extents are of the voxels' outer faces.
        origin = [l + s / 2 for l, s in zip(low, spacing)]
        return Volume(native(samples), spacing, diagonal(spacing, origin))


def load_minc(path):
    import h5py

    with h5py.File(path, "r") as file:
        dataset = file["minc-2.0/image/0/image"]
        order = text(dataset.attrs["dimorder"]).split(",")
        steps, start = {}, np.zeros(3)
        for index, name in enumerate(("xspace", "yspace", "zspace")):
            attributes = file["minc-2.0/dimensions/" + name].attrs
            cosine = np.array(attributes.get("direction_cosines", np.eye(3)[index]), float)
            steps[name] = cosine * float(attributes["step"])
            start += cosine * float(attributes["start"])
        # The last dimension is our x.
        affine = affine_of([steps[name] for name in order[::-1]], start)
        volume = Volume(native(dataset[...]), tuple(np.linalg.norm(affine[:3, :3], axis=0)), affine, "RAS")
        low, high = (np.unique(file["minc-2.0/image/0/image-" + m][...]) for m in ("min", "max"))
        if len(low) > 1 or len(high) > 1:
            raise Unreadable("slices are scaled differently")
        valid = [float(n) for n in dataset.attrs["valid_range"]]
        volume.slope = float(high[0] - low[0]) / (valid[1] - valid[0])
        volume.intercept = float(low[0]) - volume.slope * valid[0]
        return volume


def imaris_cases(path, file):
    points = file["DataSet/ResolutionLevel 0"]
    times, channels = len(points), len(points["TimePoint 0"])
    if times * channels == 1:
        return [Case(path, lambda: load_imaris(path, 0, {"t": 0, "c": 0}))]
    arguments = (["--channel", str(channels - 1)] if channels > 1 else []) + (
        ["--time", str(times - 1)] if times > 1 else [])
    last = {"t": times - 1, "c": channels - 1}
    return [Case(path, refused="several channels or times and no choice"),
            Case(path, lambda: load_imaris(path, 0, last), arguments)]


def dataset_cases(path, name, dataset, arguments):
    axes = axes_of(dataset)
    extra = [(a, n) for a, n in zip(axes, dataset.shape) if a in ("c", "t") and n > 1]
    if extra:
        chosen = {a: n - 1 for a, n in extra}
        more = [w for a, i in chosen.items()
                for w in ("--channel" if a == "c" else "--time", str(i))]
        return [Case(path, None, arguments, "several of " + ", ".join(chosen)),
                Case(path, lambda: load(path, name, chosen), arguments + more)]
    if sum(n > 1 for n in dataset.shape) > 3:
        return [Case(path, None, arguments, f"{len(dataset.shape)} dimensions")]
    return [Case(path, lambda: load(path, name, {}), arguments)]


def find(path):
    if not os.path.isfile(path):
        return None
    if not any(head_of(path, at + 8)[at:] == SIGNATURE for at in (0, 512, 1024, 2048)):
        return None
    import h5py

    with h5py.File(path, "r") as file:
        if "DataSet/ResolutionLevel 0" in file:
            return Found(imaris_cases(path, file))
        if "minc-2.0/image/0/image" in file:
            return Found([Case(path, lambda: load_minc(path))])
        names = candidates(file)
        if not names:
            return Found([Case(path, refused="no array of 3 dimensions")])
        if len(names) == 1:
            return Found(dataset_cases(path, names[0], file[names[0]], []))
        cases = [Case(path, refused=f"{len(names)} arrays and no choice")]
        for name in names:
            cases += dataset_cases(path, name, file[name], ["--dataset", name])
        return Found(cases)
