"""Samples without a header, by numpy. What they are says a file of the same name and .layout beside
them, or the table here, of the scans that are known."""

import lzma
import os
import subprocess

import numpy as np

from volume import Case, Found, Volume

ours = "raw"
needs = {"zstd": "zstd"}

KNOWN = {
    "bunny_512x512x361_i16be.raw.xz": ((512, 512, 361), ">i2"),
    "connectomics_512x512x512_u32le.raw.zst": ((512, 512, 512), "<u4"),
}


def unpacked(path, scratch):
    """The file as it is, or decompressed in the scratch folder."""
    stem, ending = os.path.splitext(path)
    if ending not in (".xz", ".zst"):
        return path
    out = os.path.join(scratch, os.path.basename(stem))
    if ending == ".zst":
        subprocess.run(["zstd", "-q", "-d", "-f", path, "-o", out], check=True)
    else:
        with lzma.open(path) as file, open(out, "wb") as plain:
            while block := file.read(1 << 24):
                plain.write(block)
    return out


def find(path):
    known = KNOWN.get(os.path.basename(path))
    if known is None and os.path.isfile(path + ".layout"):
        with open(path + ".layout", encoding="utf-8") as file:
            words = file.read().split()
        known = tuple(int(n) for n in words[:3]), words[3]
    if known is None or not os.path.isfile(path):
        return None
    size, dtype = known
    plain = unpacked(path, os.environ["VOXWELD_SCRATCH"])
    kind = np.dtype(dtype)
    arguments = ["--format", "raw", "--size", *[str(n) for n in size], "--type", kind.name, "--endian",
                 "big" if dtype[0] == ">" else "little"]
    return Found([Case(plain, lambda: Volume(np.fromfile(plain, dtype).reshape(size[::-1])),
                       arguments)], [path + ".layout"])
