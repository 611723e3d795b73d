"""Version 2 by zarr-python, with OME-Zarr's attributes; version 3 by zarrita."""

import json
import os
import subprocess

import numcodecs
import numpy as np
import zarr

from .samples import TYPES, smooth, volume

SCRIPT = os.path.join(os.path.dirname(os.path.dirname(os.path.abspath(__file__))), "write_zarr3.mjs")


def save(path, samples, chunks=(3, 2, 4), **settings):
    settings.setdefault("compressor", None)
    array = zarr.open_array(path, mode="w", shape=samples.shape, dtype=samples.dtype, chunks=chunks,
                            **settings)
    array[...] = samples


def codecs():
    for inner in ("lz4", "lz4hc", "blosclz", "zstd", "zlib"):
        for shuffle in (0, 1, 2):
            yield f"blosc_{inner}_{shuffle}", numcodecs.Blosc(inner, 3, shuffle)
    yield "zlib", numcodecs.Zlib()
    yield "gzip", numcodecs.GZip()
    yield "bz2", numcodecs.BZ2()
    yield "lz4", numcodecs.LZ4()
    yield "zstd", numcodecs.Zstd()
    yield "lzma", numcodecs.LZMA()


def write(folder):
    def at(name):
        return os.path.join(folder, name + ".zarr")

    for dtype in TYPES:
        for order in "<>":
            samples = volume(dtype).astype(np.dtype(dtype).newbyteorder(order))
            save(at(f"{dtype}{'_big' if order == '>' else ''}"), samples, fill_value=0)
    for name, codec in codecs():
        save(at(name), smooth("u2", (30, 20, 10)), (8, 8, 8), compressor=codec)
    small = volume("<i2")
    save(at("fortran"), small, order="F")
    save(at("slashes"), small, dimension_separator="/")
    save(at("null_fill"), small, fill_value=None)
    save(at("one_slice"), small[0], (2, 3))
    save(at("bool"), small > 0)
    save(at("half"), volume("f4").astype("f2"))
    save(at("complex"), small.astype("c8"))
    save(at("delta"), small, filters=[numcodecs.Delta("<i2")])
    save(at("four"), volume("u1", (7, 5, 4, 3)), (1, 2, 2, 3))
    empty = zarr.open_array(at("missing"), mode="w", shape=(9, 9, 9), chunks=(4, 4, 4), dtype="f4",
                            fill_value=np.nan)
    empty[4:8, 4:8, 4:8] = 2.5
    zipped = zarr.ZipStore(os.path.join(folder, "zipped.zarr.zip"), mode="w")
    zarr.open_array(zipped, mode="w", shape=small.shape, dtype=small.dtype)[...] = small
    zipped.close()
    ome(at)
    version_3(folder)


def axes(names, unit="micrometer"):
    kinds = {"t": "time", "c": "channel"}
    return [{"name": n, "type": kinds.get(n, "space"), **({"unit": unit} if n in "zyx" else {})}
            for n in names]


def ome_group(path, names, samples, scale):
    """Two levels, the second half as fine, with scales and translations."""
    group = zarr.open_group(path, mode="w")
    datasets = []
    for level in range(2):
        part = samples[tuple(slice(None, None, 2**level if n in "zyx" else 1) for n in names)]
        array = group.create_dataset(str(level), shape=part.shape, dtype=part.dtype, chunks=4,
                                     dimension_separator="/")
        array[...] = part
        by = [s * (2**level if n in "zyx" else 1) for n, s in zip(names, scale)]
        datasets.append({"path": str(level), "coordinateTransformations": [
            {"type": "scale", "scale": by},
            {"type": "translation", "translation": [10.0 if n in "zyx" else 0.0 for n in names]}]})
    group.attrs["multiscales"] = [{"version": "0.4", "axes": axes(names), "datasets": datasets}]


def ome(at):
    ome_group(at("ome_zyx"), "zyx", volume("u2", (9, 8, 6)), [3, 1.25, 0.5])
    ome_group(at("ome_xyz"), "xyz", volume("u2", (6, 8, 9)), [0.5, 1.25, 3])
    ome_group(at("ome_czyx"), "czyx", volume("u2", (9, 8, 6, 2)), [1, 3, 1.25, 0.5])
    ome_group(at("ome_tczyx"), "tczyx", volume("u1", (9, 8, 6, 2, 3)), [1, 1, 3, 1.25, 0.5])
    ome_group(at("ome_one_channel"), "tczyx", volume("u1", (9, 8, 6, 1, 1)), [1, 1, 3, 1.25, 0.5])


def version_3(folder):
    run = subprocess.run(["node", SCRIPT, folder], capture_output=True, text=True, check=False)
    if run.returncode != 0:
        raise FileNotFoundError("no files of version 3: " + run.stderr.strip()[:200])
    # An image of OME-Zarr 0.5 around one of these arrays.
    group = os.path.join(folder, "v3_ome.zarr")
    os.makedirs(group, exist_ok=True)
    array = os.path.join(group, "full")
    if not os.path.exists(array):
        os.rename(os.path.join(folder, "v3_for_ome.zarr"), array)
    scale = [{"type": "scale", "scale": [3, 1.25, 0.5]}]
    image = {"axes": axes("zyx", "nanometer"),
             "datasets": [{"path": "full", "coordinateTransformations": scale}]}
    with open(os.path.join(group, "zarr.json"), "w", encoding="utf-8") as file:
        json.dump({"zarr_format": 3, "node_type": "group",
                   "attributes": {"ome": {"version": "0.5", "multiscales": [image]}}}, file)
