"""By hand, after the format's description."""

import os
import zlib

import numpy as np

from .samples import volume

NAMES = {"u1": "byte", "i2": "short", "u2": "ushort", "i4": "int", "f4": "float", "f8": "double"}


def runs(data):
    """Byte runs, of repeats and of bytes as they are."""
    out, at = bytearray(), 0
    while at < len(data):
        n = 1
        while n < 127 and at + n < len(data) and data[at + n] == data[at]:
            n += 1
        if n > 1:
            out += bytes([n, data[at]])
            at += n
            continue
        n = 1
        while n < 127 and at + n < len(data) and (at + n + 1 >= len(data) or data[at + n] != data[at + n + 1]):
            n += 1
        out += bytes([128 + n]) + data[at : at + n]
        at += n
    return bytes(out)


def save(path, samples, coding="", first=None, text=False, coords="uniform"):
    first = first or ("# AmiraMesh 3D ASCII 2.0" if text else "# AmiraMesh BINARY-LITTLE-ENDIAN 2.1")
    size = samples.shape[::-1]
    data = samples.tobytes()
    if coding == "HxZip":
        data = zlib.compress(data)
    elif coding == "HxByteRLE":
        data = runs(data)
    if text:
        data = "\n".join(str(v) for v in samples.ravel()).encode()
    mark = f"({coding},{len(data)})" if coding else ""
    box = " ".join(f"{v:g}" for n, step, low in zip(size, (0.5, 1.25, 3), (-4, 5, 6.5))
                   for v in (low, low + step * (n - 1)))
    head = (f"{first}\n\n\ndefine Lattice {size[0]} {size[1]} {size[2]}\n\nParameters {{\n"
            f"    Content \"{size[0]}x{size[1]}x{size[2]} {NAMES[samples.dtype.str[1:]]}, uniform coordinates\",\n"
            f"    BoundingBox {box},\n    CoordType \"{coords}\"\n}}\n\n"
            f"Lattice {{ {NAMES[samples.dtype.str[1:]]} Data }} @1{mark}\n\n"
            "# Data section follows\n@1\n")
    with open(path, "wb") as file:
        file.write(head.encode() + data + b"\n")


def write(folder):
    def at(name):
        return os.path.join(folder, name + ".am")

    for dtype in NAMES:
        save(at(dtype), volume(dtype))
        save(at(dtype + "_big"), volume(dtype).astype(np.dtype(dtype).newbyteorder(">")),
             first="# AmiraMesh BINARY 2.1")
        save(at(dtype + "_zip"), volume(dtype), "HxZip")
    save(at("runs"), (volume("u1") > 200).astype("u1"), "HxByteRLE")
    save(at("runs_noise"), volume("u1"), "HxByteRLE")
    save(at("text"), volume("i4"), text=True)
    save(at("avizo"), volume("i2"), first="# Avizo BINARY-LITTLE-ENDIAN 2.1")
    save(at("curvilinear"), volume("i2"), coords="curvilinear")
