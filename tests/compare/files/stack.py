"""Folders of images by Pillow and tifffile."""

import os

import numpy as np
import tifffile
from PIL import Image

from .samples import volume


def folder_of(folder, name):
    path = os.path.join(folder, name)
    os.makedirs(path, exist_ok=True)
    return path


def write(folder):
    slices = volume("u1", (9, 6, 12))
    wide = volume("u2", (9, 6, 12))
    for ending in ("png", "bmp", "pgm"):
        here = folder_of(folder, ending)
        for z, samples in enumerate(slices):
            Image.fromarray(samples).save(os.path.join(here, f"slice_{z + 1}.{ending}"))
    here = folder_of(folder, "png16")
    for z, samples in enumerate(wide):
        Image.fromarray(samples.astype(np.int32)).save(os.path.join(here, f"s{z:03}.png"))
    for dtype in ("u1", "u2", "i2", "u4", "i4", "f4", "f8"):
        here = folder_of(folder, "tif_" + dtype)
        for z, samples in enumerate(volume(dtype, (9, 6, 12))):
            tifffile.imwrite(os.path.join(here, f"a{z}b.tif"), samples,
                             byteorder="<>"[z % 2], compression=[None, "zlib"][z % 2])
