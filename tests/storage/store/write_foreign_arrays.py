"""Arrays of Zarr and N5 as zarr-python writes them, with their samples beside them.

    write_foreign_arrays.py FOLDER

Writes FOLDER/cases.json: for each case the reader ("zarr" or "n5"), the path, what is chosen, the
sample type, the size in x, y, z, and the file of the samples, x fastest. Exit status 77 where
zarr-python or numcodecs is missing.
"""

import json
import os
import sys
import warnings

try:
    import numcodecs
    import numpy
    import zarr
except ImportError as error:
    print("skipped:", error)
    sys.exit(77)

warnings.simplefilter("ignore")
folder = sys.argv[1]
random = numpy.random.default_rng(5)
cases = []


def samples(dtype, shape):
    kind = numpy.dtype(dtype)
    if kind.kind == "b":
        return random.integers(0, 2, shape).astype(kind)
    if kind.kind == "f":
        return (random.integers(-10000, 10000, shape) / 8).astype(kind)
    values = random.integers(0, 1 << 62, shape, dtype=numpy.uint64)
    return (values % 251).astype(kind) if kind.itemsize > 1 else values.astype("u1").view(kind)


def add(name, path, volume, reader="zarr", **select):
    """volume: z, y, x as they must come out."""
    native = numpy.ascontiguousarray(volume)
    if native.dtype.kind == "b":
        native = native.astype("u1")
    if native.dtype.itemsize == 2 and native.dtype.kind == "f":
        native = native.astype("f4")
    native = native.astype(native.dtype.newbyteorder("<"))
    raw = os.path.join(folder, name + ".raw")
    native.tofile(raw)
    size = [1] * (3 - native.ndim) + list(native.shape)
    names = {"u": "uint", "i": "int", "f": "float"}
    cases.append({"name": name, "reader": reader, "path": path, "raw": raw, "select": select,
                  "size": size[::-1],
                  "type": names[native.dtype.kind] + str(8 * native.dtype.itemsize)})


def array(store, data, chunks, path=None, **options):
    options.setdefault("compressor", None)
    made = zarr.open_array(store, mode="w", path=path, shape=data.shape, chunks=chunks,
                           dtype=data.dtype, **options)
    made[...] = data
    return made


def place(name):
    return os.path.join(folder, name)


def version2():
    compressors = {"none": None, "zlib": numcodecs.Zlib(3), "gzip": numcodecs.GZip(3),
                   "bz2": numcodecs.BZ2(3), "zstd": numcodecs.Zstd(3), "lz4": numcodecs.LZ4(),
                   "xz": numcodecs.LZMA(), "alone": numcodecs.LZMA(format=2)}
    for cname in numcodecs.blosc.list_compressors():
        for shuffle in (0, 1, 2):
            compressors[f"blosc-{cname}-{shuffle}"] = numcodecs.Blosc(cname, 3, shuffle)
    for name, compressor in compressors.items():
        data = samples("<u2", (11, 9, 14))
        path = place(f"v2-{name}.zarr")
        array(path, data, (4, 5, 6), compressor=compressor)
        add("v2-" + name, path, data)
    for dtype in ("u1", "i1", "b1", "<i2", ">i2", ">u2", "<u4", ">i4", "<u8", ">i8", "<f2", ">f2",
                  "<f4", ">f4", "<f8", ">f8"):
        for order in "CF":
            name = "v2-" + dtype.replace("<", "l").replace(">", "b") + order
            data = samples(dtype, (7, 9, 5))
            array(place(name + ".zarr"), data, (3, 9, 4), order=order,
                  dimension_separator="/" if order == "F" else ".",
                  compressor=numcodecs.Blosc("zstd"))
            add(name, place(name + ".zarr"), data)


def partly_missing():
    data = numpy.full((9, 9, 9), -3, "<i2")
    data[0:4, 4:8, 4:8] = 7
    path = place("missing.zarr")
    made = zarr.open_array(path, mode="w", shape=data.shape, chunks=(4, 4, 4), dtype="<i2",
                           fill_value=-3, write_empty_chunks=False)
    made[0:4, 4:8, 4:8] = 7
    add("missing", path, data)


def more_dimensions():
    data = samples("<u2", (3, 2, 6, 7, 8))  # t, c, z, y, x
    group = zarr.open_group(place("ome.zarr"), mode="w")
    scales = []
    for level, step in enumerate((1, 2)):
        coarse = data[:, :, ::step, ::step, ::step]
        # A chunk holds both channels.
        array(group.store, coarse, (1, 2, 4, 4, 5), path=str(level),
              compressor=numcodecs.Blosc())
        scales.append({"path": str(level), "coordinateTransformations": [
            {"type": "scale", "scale": [1, 1, 2 * step, 0.5 * step, 0.25 * step]},
            {"type": "translation", "translation": [0, 0, step - 1, 0, 3]}]})
        for t in range(3):
            for c in range(2):
                add(f"ome-{level}-{t}-{c}", place("ome.zarr"), coarse[t, c], level=level, time=t,
                    channel=c)
    group.attrs["multiscales"] = [{
        "version": "0.4", "datasets": scales,
        "axes": [{"name": "t", "type": "time"}, {"name": "c", "type": "channel"}] +
                [{"name": n, "type": "space", "unit": "micrometer"} for n in "zyx"]}]
    group.attrs["omero"] = {"channels": [{"label": "DAPI"}, {"label": "GFP"}]}
    labels = group.create_group("labels")
    labels.attrs["labels"] = ["cells"]
    cells = labels.create_group("cells")
    array(group.store, data[0, 0], (3, 3, 3), path="labels/cells/0")
    cells.attrs["multiscales"] = [{"version": "0.4", "axes": list("zyx"),
                                   "datasets": [{"path": "0"}]}]
    add("ome-labels", place("ome.zarr"), data[0, 0], dataset="labels/cells")

    named = samples("<f4", (5, 6, 4, 3))
    made = array(place("named.zarr"), named, (2, 6, 4, 3))
    made.attrs["_ARRAY_DIMENSIONS"] = ["x", "y", "z", "channel"]
    add("named-2", place("named.zarr"), named[..., 2].transpose(2, 1, 0), channel=2)
    ones = samples("u1", (1, 1, 5, 4, 3))
    array(place("ones.zarr"), ones, (1, 1, 2, 2, 2))
    add("ones", place("ones.zarr"), ones[0, 0])


def zip_stores():
    data = samples("<u2", (10, 11, 12))
    for name, method in (("stored", 0), ("deflated", 8)):
        path = place(f"{name}.zarr.zip")
        store = zarr.ZipStore(path, mode="w", compression=method)
        array(store, data, (4, 5, 6), compressor=numcodecs.Zlib() if method == 0 else None)
        store.close()
        add("zip-" + name, path, data)
    path = place("group.zip")
    store = zarr.ZipStore(path, mode="w")
    for name in ("first", "second"):
        array(store, data + (name == "second"), (10, 11, 12), path="in/" + name)
    store.close()
    add("zip-group", path, data + 1, dataset="in/second")


def n5_arrays():
    compressors = {"raw": None, "gzip": numcodecs.GZip(3), "zlib": numcodecs.Zlib(3),
                   "bz2": numcodecs.BZ2(3), "xz": numcodecs.LZMA(), "blosc": numcodecs.Blosc()}
    for name, compressor in compressors.items():
        data = samples("u2", (11, 9, 14))
        path = place(f"{name}.n5")
        array(zarr.N5Store(path), data, (4, 5, 6), path="a/b", compressor=compressor)
        add("n5-" + name, path, data, "n5")
        add("n5-direct-" + name, os.path.join(path, "a", "b"), data, "n5")
    for dtype in ("u1", "i1", "i2", "u4", "i4", "u8", "i8", "f4", "f8"):
        data = samples(dtype, (5, 6, 7))
        array(zarr.N5Store(place(dtype + ".n5")), data, (4, 4, 4), path="v")
        add("n5-" + dtype, place(dtype + ".n5"), data, "n5", dataset="v")
    data = samples("u1", (8, 8, 8))
    store = zarr.N5Store(place("pyramid.n5"))
    group = zarr.group(store, overwrite=True)
    for level in range(3):
        step = 1 << level
        made = array(store, data[::step, ::step, ::step], (3, 3, 3), path=f"s{level}")
        if level > 0:
            made.attrs["downsamplingFactors"] = [step, step, step]
        add(f"n5-level-{level}", place("pyramid.n5"), data[::step, ::step, ::step], "n5",
            level=level)
    group.attrs["pixelResolution"] = {"dimensions": [2.0, 3.0, 4.0], "unit": "um"}


version2()
partly_missing()
more_dimensions()
zip_stores()
n5_arrays()
with open(place("cases.json"), "w", encoding="utf-8") as out:
    json.dump(cases, out)
