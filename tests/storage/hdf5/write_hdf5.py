"""Writes HDF5 files for the tests, by h5py and by numcodecs' encoders.

Usage: write_hdf5.py FOLDER NAME...
For each NAME writes NAME.h5 (or the ending its format has), and where the samples of a volume are
to be compared NAME.raw: as h5py reads them, x fastest, in native byte order.
"""

import struct
import sys

import h5py
import numpy as np

folder = sys.argv[1]
SHAPE = (20, 18, 33)
CHUNK = (5, 7, 9)


def samples(dtype, shape=SHAPE, seed=1):
    random = np.random.default_rng(seed)
    dtype = np.dtype(dtype)
    if dtype.kind == "f":
        return (random.integers(-10000, 10001, shape) / 8).astype(dtype)
    info = np.iinfo(dtype)
    values = random.integers(info.min, info.max, shape, dtype.newbyteorder("="), endpoint=True)
    return values.astype(dtype)


def smooth(dtype="u2", shape=SHAPE):
    z, y, x = np.indices(shape)
    return ((x - 9) ** 2 + (y - 9) ** 2 + z * z).astype(dtype)


def path(name, ending="h5"):
    return f"{folder}/{name}.{ending}"


def expect(name, array):
    array = np.asarray(array)
    np.ascontiguousarray(array, array.dtype.newbyteorder("=")).tofile(path(name, "raw"))


def one(name, data, **how):
    """A file with one dataset, and what h5py reads of it."""
    with h5py.File(path(name), "w", **how.pop("file", {})) as f:
        f.create_dataset("data", data=data, **how)
    with h5py.File(path(name)) as f:
        expect(name, f["data"][:])


def direct(name, data, number, values, encode):
    """Chunks encoded outside, for filters that h5py does not have."""
    kept = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
    kept.set_chunk(CHUNK)
    kept.set_filter(number, h5py.h5z.FLAG_OPTIONAL, values)
    with h5py.File(path(name), "w") as f:
        space = h5py.h5s.create_simple(data.shape)
        kind = h5py.h5t.py_create(data.dtype, logical=True)
        dataset = h5py.h5d.create(f.id, b"data", kind, space, kept)
        starts = [range(0, n, c) for n, c in zip(data.shape, CHUNK)]
        for at in np.stack(np.meshgrid(*starts, indexing="ij"), -1).reshape(-1, 3):
            chunk = np.zeros(CHUNK, data.dtype)
            part = data[tuple(slice(a, a + c) for a, c in zip(at, CHUNK))]
            chunk[tuple(slice(0, n) for n in part.shape)] = part
            dataset.write_direct_chunk(tuple(int(a) for a in at), encode(chunk), 0)
    expect(name, data)


def bit_planes(chunk):
    """All bits of one place together, the last few samples as they are."""
    flat = chunk.reshape(-1)
    count = flat.size // 8 * 8
    bits = np.unpackbits(flat[:count].view("u1").reshape(count, -1), axis=1, bitorder="little")
    return np.packbits(bits.T, axis=1, bitorder="little").tobytes(), flat[count:].tobytes()


def blocked(chunk, encode, head):
    """In blocks of 64 samples, each encoded for itself with its length before it."""
    flat, out = chunk.reshape(-1), head
    for at in range(0, flat.size // 8 * 8, 64):
        block = flat[at : min(at + 64, flat.size // 8 * 8)]
        coded = encode(bit_planes(block)[0])
        out += struct.pack(">I", len(coded)) + coded
    return out + flat[flat.size // 8 * 8 :].tobytes()


def lz4_blocks(chunk):
    from numcodecs import LZ4

    raw, out = chunk.tobytes(), b""
    out = struct.pack(">QI", len(raw), 200)
    for at in range(0, len(raw), 200):
        coded = LZ4().encode(raw[at : at + 200])[4:]
        coded = raw[at : at + 200] if len(coded) >= len(raw[at : at + 200]) else coded
        out += struct.pack(">I", len(coded)) + coded
    return out


def encoded(name):
    from numcodecs import LZ4, Blosc, Zstd

    data = smooth()
    if name == "blosc":
        direct(name, data, 32001, (2, 2, 2, 630, 5, 1, 0), Blosc("lz4", 5, 1).encode)
    elif name == "zstd":
        direct(name, data, 32015, (3,), Zstd(3).encode)
    elif name == "lz4":
        direct(name, data, 32004, (200,), lz4_blocks)
    elif name == "bitshuffle":
        direct(name, data, 32008, (0, 3, 2, 2048), lambda c: b"".join(bit_planes(c)))
    else:
        head = struct.pack(">QI", 630, 128)
        block = lambda c: blocked(c, lambda b: LZ4().encode(b)[4:], head)
        direct(name, data, 32008, (0, 3, 2, 64, 2), block)


def typed(name):
    one(name, samples(name[5:]))


def chunked(name):
    how = {
        "plain": {},
        "gzip": dict(compression="gzip", shuffle=True, fletcher32=True),
        "fletcher": dict(fletcher32=True),
        "szip": dict(compression="szip"),
        "lzf": dict(compression="lzf"),
        "lzfshuffle": dict(compression="lzf", shuffle=True),
        "scaleoffset": dict(scaleoffset=0),
        "latest": dict(compression="gzip", file=dict(libver="latest")),
        "growing": dict(maxshape=(None, None, None), file=dict(libver="latest")),
        "growing1": dict(maxshape=(None, 18, 33), file=dict(libver="latest")),
        "userblock": dict(compression="gzip", file=dict(userblock_size=1024)),
    }[name[8:]]
    one(name, smooth(), chunks=CHUNK, **how)


def bigendian(name):
    one(name, samples(">i4"), chunks=CHUNK, compression="gzip", shuffle=True)


def random(name):  # lzf makes it no shorter, and leaves chunks as they are
    one(name, samples("u1"), chunks=CHUNK, compression="lzf")


def userblock(name):
    one(name, samples("u2"), file=dict(userblock_size=512))


def half(name):
    one(name, samples("f2"))
    expect(name, h5py.File(path(name))["data"][:].astype("f4"))


def boolean(name):
    one(name, samples("u1") > 99, chunks=CHUNK, compression="gzip")


def names(name):
    kind = h5py.enum_dtype({"air": 0, "bone": 3, "skin": 200}, "u1")
    with h5py.File(path(name), "w") as f:
        f.create_dataset("data", SHAPE, kind)[...] = samples("u1") % 3
    with h5py.File(path(name)) as f:
        expect(name, f["data"][:])


def sparse(name):
    with h5py.File(path(name), "w") as f:
        d = f.create_dataset("data", SHAPE, ">i2", chunks=CHUNK, fillvalue=-7, compression="gzip")
        d[3:11, 5:9, 20:30] = samples("i2")[3:11, 5:9, 20:30]
        expect(name, d[:])


def unwritten(name):
    with h5py.File(path(name), "w") as f:
        f.create_dataset("data", SHAPE, "f4", fillvalue=2.5)
        expect(name, f["data"][:])


def huge(name):
    with h5py.File(path(name), "w") as f:
        f.create_dataset("data", (10240, 10240, 10486), "u1", chunks=(64, 64, 64))


def tzyxc(name):
    with h5py.File(path(name), "w") as f:
        d = f.create_dataset("exported_data", data=samples("u1", (2, 6, 7, 8, 3)), chunks=(1, 4, 4, 4, 2))
        d.attrs["axistags"] = (
            '{"axes": [%s]}'
            % ", ".join(
                '{"key": "%s", "typeFlags": 2, "resolution": %s, "description": ""}' % (k, r)
                for k, r in zip("tzyxc", (0, 2.5, 1.5, 0.5, 0))
            )
        )
        expect(name, d[1, :, :, :, 2])


def labelled(name):
    data = samples("i2", (5, 6, 7))
    with h5py.File(path(name), "w") as f:
        d = f.create_dataset("data", data=data, chunks=(3, 3, 3))
        for i, key in enumerate("xyz"):
            d.dims[i].label = key
        d.attrs["element_size_um"] = [3.0, 2.0, 1.0]
    expect(name, data.transpose(2, 1, 0))


def fourd(name):
    one(name, samples("u1", (3, 4, 5, 6)))


def extra(name):
    one(name, samples("u1", (1, 4, 5, 1, 6)))


def several(name):
    with h5py.File(path(name), "w") as f:
        f["a/small"] = samples("u2", (3, 4, 5))
        f["a/large"] = samples("f4", (6, 7, 8))
        f["z"] = h5py.SoftLink("/a/large")
        f["a/loop"] = h5py.SoftLink("/")
        f["flat"] = samples("u1", (30, 40))
        f["none"] = h5py.SoftLink("/nowhere")
        f["text"] = "some words"
        f.create_dataset("pairs", (3, 4, 5), np.dtype([("a", "u1"), ("b", "f4")]))
        expect(name, f["a/large"][:])


def refused(name):
    kind = {
        "compound": np.dtype([("a", "u1"), ("b", "f4")]),
        "complex": np.dtype("c8"),
        "text": h5py.string_dtype(),
        "quad": np.dtype(np.longdouble),
    }[name[8:]]
    with h5py.File(path(name), "w") as f:
        f.create_dataset("data", (3, 4, 5), kind)


def empty(name):
    with h5py.File(path(name), "w") as f:
        f.create_group("nothing")
        f.create_dataset("zero", (0, 4, 5), "u1")


def filtered(name):
    direct(name, smooth(), 32013, (1, 2), lambda c: c.tobytes())


def external(name):
    one(name + "-other", samples("u2"))
    with h5py.File(path(name), "w") as f:
        f["data"] = h5py.ExternalLink(name + "-other.h5", "/data")
    expect(name, samples("u2"))


def outside(name):
    data = samples("u2")
    with h5py.File(path(name), "w") as f:
        d = f.create_dataset("data", SHAPE, "u2", external=[(path(name, "bin"), 0, h5py.h5f.UNLIMITED)])
        d[:] = data
    expect(name, data)


def virtual(name):
    one(name + "-part", samples("u2"))
    layout = h5py.VirtualLayout(SHAPE, "u2")
    layout[:] = h5py.VirtualSource(name + "-part.h5", "data", SHAPE)
    with h5py.File(path(name), "w") as f:
        f.create_virtual_dataset("data", layout)


def nexus(name):
    with h5py.File(path(name), "w") as f:
        f.attrs["default"] = "entry"
        entry = f.create_group("entry")
        entry.attrs["default"] = "data"
        entry["other"] = samples("u1", (3, 4, 5))
        group = entry.create_group("data")
        group.attrs["NX_class"], group.attrs["signal"] = "NXdata", "signal"
        group.attrs["axes"] = ["height", "down", "width"]
        entry["detector"] = samples("f4", (4, 5, 6))
        group["signal"] = h5py.SoftLink("/entry/detector")
        group["height"] = 10 + 0.5 * np.arange(4)
        group["down"] = np.float32(7) - np.float32(0.25) * np.arange(5, dtype="f4")
        group["width"] = 0.125 * np.arange(7)  # edges
        if name == "nexus-uneven":
            group["height"][2] = 11.2
        for axis in ("height", "down", "width"):
            group[axis].attrs["units"] = "millimeter"
        if name == "nexus-units":
            group["down"].attrs["units"] = "um"
        expect(name, group["signal"][:])


def tomo(name):
    with h5py.File(path(name), "w") as f:
        group = f.create_group("entry/data")
        group.attrs["NX_class"], group.attrs["signal"] = "NXdata", "data"
        group["data"] = samples("u2", (9, 4, 5))
        group["rotation_angle"] = np.arange(9) * 20.0


def cremi(name):
    with h5py.File(path(name), "w") as f:
        d = f.create_dataset("volumes/raw", data=samples("u1", (4, 5, 6)))
        d.attrs["resolution"], d.attrs["offset"] = [40.0, 4.0, 8.0], [400.0, 40.0, 80.0]
        expect(name, d[:])


def letters(text):
    return np.frombuffer(str(text).encode(), "S1")


def imaris(name):
    with h5py.File(path(name, "ims"), "w") as f:
        image = f.create_group("DataSetInfo/Image")
        for i, (lo, hi) in enumerate([(10, 13), (2, 22), (5, 1)]):
            image.attrs[f"ExtMin{i}"], image.attrs[f"ExtMax{i}"] = letters(lo), letters(hi)
        image.attrs["Unit"] = letters("um")
        for level, (z, y, x) in enumerate([(4, 5, 6), (2, 3, 3)]):
            for time in range(2):
                for channel in range(3):
                    f.require_group(f"DataSetInfo/Channel {channel}").attrs["Name"] = letters(f"Dye {channel}")
                    group = f.create_group(f"DataSet/ResolutionLevel {level}/TimePoint {time}/Channel {channel}")
                    for key, size in zip("XYZ", (x, y, z)):
                        group.attrs["ImageSize" + key] = letters(size)
                    data = samples("u2", (8, 8, 8), 100 * level + 10 * time + channel)
                    group.create_dataset("Data", data=data, chunks=(4, 4, 4), compression="gzip")
                    if (level, time, channel) in ((0, 1, 2), (1, 0, 0)):
                        expect(f"{name}-{level}", data[:z, :y, :x])


def minc(name):
    real = {"minc-slices": np.array([10.0, 10, 11, 10]), "minc-float": np.full(4, 10.0)}
    with h5py.File(path(name, "mnc"), "w") as f:
        image = f.create_group("minc-2.0/image/0")
        data = samples("f4" if name == "minc-float" else "i2", (4, 5, 6))
        d = image.create_dataset("image", data=data, chunks=(2, 3, 4), compression="gzip")
        d.attrs["dimorder"] = np.bytes_("zspace,xspace,yspace")
        d.attrs["valid_range"] = [-32000.0, 32000.0]
        image["image-max"] = real.get(name, np.full(4, 10.0))
        image["image-min"] = np.full(4, -6.0)
        for key, step, start, cosines in (
            ("xspace", -2.0, 30.0, (0.8, 0.6, 0)),
            ("yspace", 1.5, -10.0, (-0.6, 0.8, 0)),
            ("zspace", 3.0, 5.0, (0, 0, 1)),
        ):
            axis = f.create_dataset(f"minc-2.0/dimensions/{key}", (), "i4")
            axis.attrs["step"], axis.attrs["start"] = step, start
            axis.attrs["direction_cosines"] = cosines
            axis.attrs["units"], axis.attrs["spacing"] = np.bytes_("mm"), np.bytes_("regular__")
            axis.attrs["length"] = np.int32({"x": 5, "y": 6, "z": 4}[key[0]])
        for bound in ("image-max", "image-min"):
            image[bound].attrs["dimorder"] = np.bytes_("zspace")
    expect(name, data.transpose(0, 2, 1))
    if name == "minc":
        import nibabel

        loaded = nibabel.load(path(name, "mnc"))
        np.savetxt(path(name, "affine"), loaded.affine)
        np.ascontiguousarray(loaded.get_fdata(), "f8").tofile(path(name, "real"))


def measured(name):
    shape = (512, 1024, 1024)
    random = np.random.default_rng(1)
    with h5py.File(path(name), "w") as f:
        d = f.create_dataset("data", shape, "u2", chunks=(64, 64, 64), compression="gzip", compression_opts=4)
        y, x = np.indices(shape[1:])
        for z in range(0, shape[0], 64):
            zz = np.arange(z, z + 64)[:, None, None]
            ball = 400 - np.sqrt((x - 512.0) ** 2 + (y - 512.0) ** 2 + 4 * (zz - 256.0) ** 2)
            d[z : z + 64] = np.clip(1000 + 20 * ball, 0, 4000) + random.integers(0, 64, (64,) + shape[1:])


makers = {
    "type": typed, "chunked": chunked, "bigendian": bigendian, "random": random, "userblock": userblock,
    "half": half, "boolean": boolean, "names": names, "sparse": sparse, "unwritten": unwritten, "huge": huge,
    "tzyxc": tzyxc, "labelled": labelled, "fourd": fourd, "extra": extra, "several": several,
    "refused": refused, "empty": empty, "filtered": filtered, "external": external, "outside": outside,
    "virtual": virtual, "nexus": nexus, "tomo": tomo, "cremi": cremi, "imaris": imaris, "minc": minc,
    "measured": measured, "blosc": encoded, "zstd": encoded, "lz4": encoded, "bitshuffle": encoded,
}  # fmt: skip
for given in sys.argv[2:]:
    makers[given.split("-")[0]](given)
