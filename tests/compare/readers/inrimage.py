"""Inrimage 4, after its description: a header of lines KEY=value in blocks of 256 bytes."""

import gzip
import os

import numpy as np

from volume import Case, Found, Volume, diagonal

ours = "inrimage"
needs = {}


def load(path):
    with (gzip.open if path.endswith(".gz") else open)(path, "rb") as file:
        data = file.read()
    end = data.index(b"##}\n") + 4
    lines = data[:end].decode("latin-1").splitlines()
    fields = dict(line.split("=", 1) for line in lines if "=" in line and not line.startswith("#"))
    bits = int(fields["PIXSIZE"].split()[0])
    kind = {"unsigned fixed": "u", "signed fixed": "i", "float": "f"}[fields["TYPE"].strip()]
    order = ">" if fields.get("CPU", "decm").strip() in ("sun", "sgi") else "<"
    size = [int(fields[k]) for k in ("XDIM", "YDIM", "ZDIM")]
    samples = np.frombuffer(data[end:], f"{order}{kind}{bits // 8}", count=int(np.prod(size)))
    spacing = tuple(abs(float(fields.get(k, 1))) or 1.0 for k in ("VX", "VY", "VZ"))
    origin = [float(fields.get(k, 0)) for k in ("TX", "TY", "TZ")]
    scale = fields.get("SCALE", "").strip()
    slope = 2.0 ** int(scale[3:]) if scale.startswith("2**") else 1.0
    return Volume(samples.reshape(size[::-1]), spacing, diagonal(spacing, origin), slope=slope)


def find(path):
    if not os.path.isfile(path) or not path.endswith((".inr", ".inr.gz")):
        return None
    return Found([Case(path, lambda: load(path))])
