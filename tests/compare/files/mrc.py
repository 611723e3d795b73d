"""By mrcfile."""

import os

import mrcfile
import numpy as np

from .samples import volume


def save(path, samples, voxel=(0.5, 1.25, 3), change=None, **settings):
    with mrcfile.new(path, overwrite=True, **settings) as file:
        file.set_data(samples)
        file.voxel_size = voxel
        if change:
            change(file)


def write(folder):
    def at(name):
        return os.path.join(folder, name)

    for dtype in ("i1", "i2", "u2", "f4"):
        samples = np.nan_to_num(volume(dtype), posinf=1, neginf=-1) if dtype == "f4" else volume(dtype)
        for order in "<>":
            name = f"{dtype}{'_big' if order == '>' else ''}.mrc"
            save(at(name), samples.astype(np.dtype(dtype).newbyteorder(order)))
    small = volume("i2")
    save(at("half.mrc"), np.nan_to_num(volume("f4"), posinf=1, neginf=-1).astype("f2"))
    save(at("gzip.mrc.gz"), small, compression="gzip")
    save(at("complex.mrc"), small.astype("c8"))
    save(at("stack.mrc"), volume("u2", (7, 5, 24)).reshape(6, 4, 5, 7))
    save(at("no_cell.mrc"), small, voxel=0)

    def origin(file):
        file.header.origin = (10, 20, 30)

    def start(file):
        file.header.nxstart, file.header.nystart, file.header.nzstart = -3, 4, 5

    def axes(order):
        def change(file):
            file.header.mapc, file.header.mapr, file.header.maps = order
        return change

    def extended(file):
        file.set_extended_header(np.arange(300, dtype="u1"))

    save(at("origin.mrc"), small, change=origin)
    save(at("start.map"), small, change=start)
    save(at("extended.mrc"), small, change=extended)
    for order in ((2, 1, 3), (3, 2, 1), (3, 1, 2), (2, 3, 1)):
        save(at("axes_%d%d%d.map" % order), small, voxel=1, change=axes(order))
