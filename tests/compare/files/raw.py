"""By numpy, with what they are in files of the same name and .layout."""

import os

import numpy as np

from .samples import TYPES, volume


def write(folder):
    for dtype in TYPES:
        for order in "<>":
            stored = volume(dtype).astype(np.dtype(dtype).newbyteorder(order))
            path = os.path.join(folder, f"{dtype}{'_big' if order == '>' else ''}.raw")
            stored.tofile(path)
            with open(path + ".layout", "w", encoding="utf-8") as file:
                file.write("7 5 4 " + order + dtype + "\n")
