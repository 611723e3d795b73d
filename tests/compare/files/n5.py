"""By zarr-python."""

import json
import os

import numcodecs
import zarr

from .samples import TYPES, smooth, volume


def save(store, name, samples, **settings):
    array = zarr.open_array(store, path=name, mode="w", shape=samples.shape, dtype=samples.dtype,
                            chunks=(3, 2, 4), **settings)
    array[...] = samples


def write(folder):
    store = zarr.N5Store(os.path.join(folder, "types.n5"))
    for dtype in TYPES:
        save(store, dtype, volume(dtype), compressor=None)
    store = zarr.N5Store(os.path.join(folder, "codings.n5"))
    for name, codec in (("raw", None), ("gzip", numcodecs.GZip()), ("bzip2", numcodecs.BZ2()),
                        ("zlib", numcodecs.Zlib()), ("xz", numcodecs.LZMA()),
                        ("blosc", numcodecs.Blosc()), ("zstd", numcodecs.Zstd())):
        save(store, name, smooth("u2", (30, 20, 10)), compressor=codec)
    path = os.path.join(folder, "placed.n5")
    store = zarr.N5Store(path)
    save(store, "s0", volume("u1"), compressor=None)
    described = os.path.join(path, "s0", "attributes.json")
    with open(described, encoding="utf-8") as file:
        attributes = json.load(file)
    attributes["pixelResolution"] = {"unit": "nm", "dimensions": [0.5, 1.25, 3]}
    with open(described, "w", encoding="utf-8") as file:
        json.dump(attributes, file)
