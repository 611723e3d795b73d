"""By h5py, as ilastik, Imaris and MINC lay their files out."""

import json
import os

import h5py
import numpy as np

from .samples import TYPES, smooth, volume


def letters(value):
    return np.array([c.encode() for c in str(value)], "S1")


def imaris(path, samples):
    """[t, c, z, y, x], padded as Imaris does."""
    with h5py.File(path, "w") as file:
        info = file.create_group("DataSetInfo/Image")
        size = samples.shape[:1:-1]
        for axis, (n, step) in enumerate(zip(size, (0.5, 1.25, 3))):
            info.attrs["XYZ"[axis]] = letters(n)
            info.attrs[f"ExtMin{axis}"] = letters(10.0)
            info.attrs[f"ExtMax{axis}"] = letters(10.0 + n * step)
        info.attrs["Unit"] = letters("um")
        for t, times in enumerate(samples):
            for c, image in enumerate(times):
                group = file.create_group(f"DataSet/ResolutionLevel 0/TimePoint {t}/Channel {c}")
                for axis, n in zip("XYZ", size):
                    group.attrs["ImageSize" + axis] = letters(n)
                padded = np.zeros([-(-n // 8) * 8 for n in image.shape], image.dtype)
                padded[tuple(slice(n) for n in image.shape)] = image
                group.create_dataset("Data", data=padded, chunks=(8, 8, 8), compression="gzip")


def minc(path, samples, steps, slices_differ=False):
    with h5py.File(path, "w") as file:
        root = file.create_group("minc-2.0")
        image = root.create_group("image/0")
        data = image.create_dataset("image", data=samples)
        data.attrs["dimorder"] = np.bytes_("zspace,yspace,xspace")
        data.attrs["valid_range"] = np.array([-32768.0, 32767.0])
        count = samples.shape[0] if slices_differ else 1
        image.create_dataset("image-min", data=np.arange(count) * 1.0 if slices_differ else np.float64(-10))
        image.create_dataset("image-max", data=np.arange(count) + 9.0 if slices_differ else np.float64(300))
        for name, n, step, start in zip("xyz", samples.shape[::-1], steps, (1.0, 2.0, 3.0)):
            axis = root.create_group("dimensions") if name == "x" else root["dimensions"]
            made = axis.create_dataset(name + "space", data=0)
            made.attrs["step"], made.attrs["start"], made.attrs["length"] = step, start, n
            made.attrs["direction_cosines"] = np.eye(3)["xyz".index(name)]


def write(folder):
    def at(name):
        return os.path.join(folder, name)

    for dtype in TYPES:
        for order in "<>":
            kind = np.dtype(dtype).newbyteorder(order)
            with h5py.File(at(f"{dtype}{'_big' if order == '>' else ''}.h5"), "w") as file:
                file.create_dataset("volume", data=volume(dtype).astype(kind), dtype=kind)
    scan = smooth("u2", (40, 30, 20))
    for name, settings in (("gzip", {"compression": "gzip"}), ("lzf", {"compression": "lzf"}),
                           ("shuffle", {"compression": "gzip", "shuffle": True}),
                           ("fletcher32", {"fletcher32": True}), ("szip", {"compression": "szip"})):
        with h5py.File(at(name + ".h5"), "w") as file:
            try:
                file.create_dataset("a/b", data=scan, chunks=(8, 16, 8), **settings)
            except ValueError:  # this library has no such encoder
                continue
    with h5py.File(at("two.h5"), "w") as file:
        file["first"], file["second"] = scan, volume("f4")
    with h5py.File(at("half.h5"), "w") as file:
        file["a"] = volume("f4").astype("f2")
    with h5py.File(at("bool.h5"), "w") as file:
        file["a"] = volume("i2") > 0
    for axes, shape in (("zyxc", (7, 5, 4, 2)), ("tzyxc", (7, 5, 4, 3, 2)), ("xyz", (4, 5, 7))):
        samples = volume("u2", tuple(shape))
        with h5py.File(at(f"axistags_{axes}.h5"), "w") as file:
            data = file.create_dataset("exported_data", data=samples.reshape(
                [{"x": 7, "y": 5, "z": 4, "c": 2, "t": 3}[a] for a in axes]))
            data.attrs["axistags"] = json.dumps({"axes": [{"key": a, "typeFlags": 2} for a in axes]})
    with h5py.File(at("element_size.h5"), "w") as file:
        file.create_dataset("t0/channel0", data=scan).attrs["element_size_um"] = [3.0, 1.25, 0.5]
    with h5py.File(at("no_array.h5"), "w") as file:
        file["list"] = np.arange(10)
    imaris(at("one.ims"), volume("u1", (7, 5, 4)).reshape(1, 1, 4, 5, 7))
    imaris(at("several.ims"), volume("u2", (7, 5, 24)).reshape(3, 2, 4, 5, 7))
    minc(at("plain.mnc"), volume("i2"), (0.5, 1.25, 3))
    minc(at("negative.mnc"), volume("i2"), (-0.5, 1.25, -3))
    minc(at("slices_differ.mnc"), volume("i2"), (0.5, 1.25, 3), True)
