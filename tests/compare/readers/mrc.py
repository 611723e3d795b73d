"""MRC and CCP4 by mrcfile. Its arrays are in the file's order; axes are put in place here."""

import os
import warnings

import numpy as np

from volume import Case, Found, Unreadable, Volume, diagonal, native

ours = "mrc"
needs = {"mrcfile": "python3-mrcfile"}


def load(path):
    import mrcfile

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        with mrcfile.open(path, permissive=True) as file:
            if file.data is None:
                raise Unreadable("mrcfile: cannot read it")
            header = file.header.copy()
            data = native(np.array(file.data))
    data = data.reshape((1,) * (3 - data.ndim) + data.shape)
    # mapc: which of x, y, z runs fastest, and so on.
    order = [int(header[k]) - 1 for k in ("mapc", "mapr", "maps")]
    if sorted(order) != [0, 1, 2]:
        order = [0, 1, 2]
    samples = data.transpose([2 - order.index(axis) for axis in (2, 1, 0)])
    cell = [float(header["cella"][a]) for a in "xyz"]
    count = [int(header[k]) for k in ("mx", "my", "mz")]
    if not all(c > 0 for c in cell) or not all(n > 0 for n in count):
        return Volume(samples)
    spacing = tuple(c / n for c, n in zip(cell, count))
    start = [int(header[k]) for k in ("nxstart", "nystart", "nzstart")]
    place = [0.0] * 3
    for fast in range(3):
        place[order[fast]] = start[fast] * spacing[order[fast]]
    origin = [float(header["origin"][a]) for a in "xyz"]
    # ORIGIN is what newer programs go by; where it is 0 the start is.
    return Volume(samples, spacing, diagonal(spacing, origin if any(origin) else place), unit="angstrom")


def find(path):
    if not os.path.isfile(path) or not path.lower().endswith((".mrc", ".map", ".rec", ".ccp4", ".st",
                                                              ".mrc.gz")):
        return None
    import mrcfile

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        with mrcfile.open(path, permissive=True, header_only=True) as file:
            mode, group = int(file.header.mode), int(file.header.ispg)
    if mode not in (0, 1, 2, 6, 12):
        return Found([Case(path, refused=f"samples of mode {mode}")])
    if group >= 401:
        return Found([Case(path, refused="a stack of volumes")])
    return Found([Case(path, lambda: load(path))])
