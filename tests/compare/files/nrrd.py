"""By teem, and headers by hand where teem has no switch for what they say."""

import os
import subprocess

import numpy as np

from .samples import TYPES, rotation, volume

NAMES = {"u1": "uchar", "i1": "signed char", "u2": "ushort", "i2": "short", "u4": "uint", "i4": "int",
         "u8": "unsigned long long", "i8": "long long", "f4": "float", "f8": "double"}


def by_hand(path, samples, fields, encoding="raw"):
    """The dtype's byte order is the file's."""
    order = {">": "big", "<": "little"}.get(samples.dtype.str[0])
    head = ["NRRD0005", "type: " + NAMES[samples.dtype.str[1:]], f"dimension: {samples.ndim}",
            "sizes: " + " ".join(str(n) for n in samples.shape[::-1]), "encoding: " + encoding]
    head += ["endian: " + order] if order else []
    with open(path, "wb") as file:
        file.write("\n".join(head + fields + ["", ""]).encode())
        if encoding == "raw":
            file.write(samples.tobytes())
        else:
            np.savetxt(file, samples.reshape(-1, samples.shape[-1]), fmt="%d")


def teem(source, target, *options):
    run = subprocess.run(["teem-unu", "save", "-f", "nrrd", "-i", source, "-o", target, *options],
                         capture_output=True, text=True, check=False)
    if run.returncode != 0:
        raise RuntimeError(run.stderr)


def write(folder):
    def at(name):
        return os.path.join(folder, name)

    for dtype in TYPES:
        for order in "<>":
            name = f"{dtype}{'_big' if order == '>' else ''}"
            samples = volume(dtype).astype(np.dtype(dtype).newbyteorder(order))
            by_hand(at(name + ".nrrd"), samples, ["spacings: 0.5 1.25 3"])
            teem(at(name + ".nrrd"), at(name + "_gz.nrrd"), "-e", "gzip", "-en",
                 "big" if order == ">" else "little")
    teem(at("i2.nrrd"), at("ascii.nrrd"), "-e", "ascii")
    teem(at("u2_big.nrrd"), at("bzip2.nrrd"), "-e", "bzip2")
    teem(at("f4.nrrd"), at("hex.nrrd"), "-e", "hex")
    teem(at("f8.nrrd"), at("detached.nhdr"), "-e", "raw", "-en", "big")
    teem(at("i4.nrrd"), at("detached_gz.nhdr"), "-e", "gzip")
    steps = rotation(30, 20) * [0.4, 0.7, 2.5]
    turned = " ".join("(%.15g,%.15g,%.15g)" % tuple(steps[:, a]) for a in range(3))
    small = volume("<i2")
    for space in ("left-posterior-superior", "RAS", "LAS", "scanner-xyz"):
        by_hand(at(f"turned_{space}.nrrd"), small,
                ["space: " + space, "space directions: " + turned, "space origin: (-10.5,20,1000.25)",
                 'space units: "mm" "mm" "mm"', "kinds: domain domain domain"])
    by_hand(at("flipped.nrrd"), small, ["space: LPS", "space directions: (-1,0,0) (0,-2,0) (0,0,3)",
                                        "space origin: (1,2,3)"])
    by_hand(at("sheared.nrrd"), small, ["space: LPS", "space directions: (1,0,0) (0.2,1,0) (0,0.1,2)",
                                        "space origin: (1,2,3)"])
    by_hand(at("permuted.nrrd"), small, ["space: RAS", "space directions: (0,0,2) (1.5,0,0) (0,1,0)"])
    by_hand(at("negative_spacing.nrrd"), small, ["spacings: -1 2 3"])
    by_hand(at("no_spacing.nrrd"), small, ["spacings: nan nan 2"])
    by_hand(at("one_more_axis.nrrd"), small[np.newaxis], ["kinds: space space space list"])
    by_hand(at("one_first.nrrd"), small[..., np.newaxis],
            ["kinds: scalar space space space", "space: LPS",
             "space directions: none (1,0,0) (0,2,0) (0,0,3)", "space origin: (0,0,0)"])
    by_hand(at("vectors.nrrd"), volume("u1", (3, 7, 5, 4)), ["kinds: 3-color space space space"])
    by_hand(at("times.nrrd"), volume("u1", (7, 5, 4, 3)), ["kinds: space space space time"])
    by_hand(at("text.nrrd"), volume("<i4"), ["spacings: 1 1 2"], "ascii")
