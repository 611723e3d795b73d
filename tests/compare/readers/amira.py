"""Amira meshes of uniform lattices, after the format's description."""

import os
import re
import zlib

import numpy as np

from volume import Case, Found, Unreadable, Volume, diagonal, head_of

ours = "amira"
needs = {}

TYPES = {"byte": "u1", "short": "i2", "ushort": "u2", "int": "i4", "int32": "i4", "float": "f4",
         "double": "f8"}


def unpacked_runs(data, count):
    """Byte runs: n below 128 repeats the next byte, above it n - 128 bytes follow as they are."""
    out, at = bytearray(), 0
    while len(out) < count:
        n = data[at]
        if n < 128:
            out += data[at + 1 : at + 2] * n
            at += 2
        else:
            out += data[at + 1 : at + 1 + n - 128]
            at += 1 + n - 128
    return bytes(out)


def load(path, chosen):
    with open(path, "rb") as file:
        data = file.read()
    end = re.search(rb"\n@1[ \r]*\n", data).start()
    head = data[:end].decode("latin-1")
    size = [int(n) for n in re.search(r"define\s+Lattice\s+(\d+)\s+(\d+)\s+(\d+)", head).groups()]
    coords = re.search(r'CoordType\s+"(\w+)"', head)
    if coords and coords.group(1) != "uniform":
        raise Unreadable("coordinates are " + coords.group(1))
    kind, name, mark, coding = chosen
    begin = re.search(rf"\n@{mark}[ \r]*\n".encode(), data).end()
    count = int(np.prod(size))
    if "ASCII" in head.splitlines()[0]:
        values = data[begin:].split(b"\n@")[0].split()[:count]
        samples = np.array(values).astype("f8" if kind in ("float", "double") else "i8").astype(TYPES[kind])
    else:
        order = "<" if "LITTLE" in head.splitlines()[0] else ">"
        dtype = np.dtype(order + TYPES[kind])
        body = data[begin:]
        if coding.startswith("HxZip"):
            body = zlib.decompressobj().decompress(body)
        elif coding.startswith("HxByteRLE"):
            body = unpacked_runs(body, count * dtype.itemsize)
        samples = np.frombuffer(body, dtype, count=count)
    volume = Volume(samples.reshape(size[::-1]))
    box = re.search(r"BoundingBox\s+([-+.\deE ]+)", head)
    if box:
        b = [float(n) for n in box.group(1).split()]
        # Of the voxels' centres.
        volume.spacing = tuple((b[2 * a + 1] - b[2 * a]) / max(1, size[a] - 1) for a in range(3))
        volume.affine = diagonal(volume.spacing, b[::2])
    return volume


def find(path):
    if not os.path.isfile(path) or not re.match(rb"# (AmiraMesh|Avizo)", head_of(path, 16)):
        return None
    head = head_of(path, 20_000).decode("latin-1")
    arrays = re.findall(r"Lattice\s*\{\s*(\w+)(?:\[(\d+)\])?\s+(\w+)\s*\}\s*=?\s*@(\d+)(\(\w+,?\d*\))?", head)
    if not arrays:
        return Found([Case(path, refused="no lattice")])
    cases = []
    for kind, values, name, mark, coding in arrays:
        arguments = ["--dataset", name] if len(arrays) > 1 else []
        if values not in ("", "1"):
            cases.append(Case(path, None, arguments, values + " values a sample"))
            continue
        chosen = kind, name, mark, coding.strip("()")
        cases.append(Case(path, lambda c=chosen: load(path, c), arguments))
    if len(arrays) > 1:
        cases.append(Case(path, refused=f"{len(arrays)} arrays and no choice"))
    return Found(cases)
