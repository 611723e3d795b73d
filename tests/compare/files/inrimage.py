"""By hand, after the format's description."""

import gzip
import os

import numpy as np

from .samples import TYPES, volume

KINDS = {"u": "unsigned fixed", "i": "signed fixed", "f": "float"}


def data_of(samples, fields=()):
    kind = samples.dtype.str
    size = samples.shape[::-1]
    lines = [f"{axis}DIM={n}" for axis, n in zip("XYZ", size)] + [
        "VDIM=1", "TYPE=" + KINDS[kind[1]], f"PIXSIZE={int(kind[2:]) * 8} bits",
        "CPU=" + ("sun" if kind[0] == ">" else "decm"), *fields]
    head = "#INRIMAGE-4#{\n" + "\n".join(lines) + "\n"
    fill = -(len(head) + 4) % 256
    return (head + "\n" * fill + "##}\n").encode() + samples.tobytes()


def write(folder):
    for dtype in TYPES:
        for order in "<>":
            samples = volume(dtype).astype(np.dtype(dtype).newbyteorder(order))
            data = data_of(samples, ["VX=0.5", "VY=1.25", "VZ=3", "TX=-1", "TY=2", "TZ=3.5"])
            path = os.path.join(folder, f"{dtype}{'_big' if order == '>' else ''}.inr")
            with open(path, "wb") as file:
                file.write(data)
            with gzip.open(path + ".gz", "wb") as file:
                file.write(data)
    with open(os.path.join(folder, "scaled.inr"), "wb") as file:
        file.write(data_of(volume("u1"), ["VX=1", "VY=1", "VZ=1", "SCALE=2**-3"]))
