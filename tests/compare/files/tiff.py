"""Multi-page TIFF by tifffile; what it cannot compress by itself by libtiff's tiffcp."""

import os
import subprocess

import numpy as np
import tifffile

from .samples import TYPES, smooth, volume


def write(folder):
    def at(name):
        return os.path.join(folder, name + ".tif")

    for dtype in TYPES:
        for order in "<>":
            tifffile.imwrite(at(f"{dtype}{'_big' if order == '>' else ''}"), volume(dtype),
                             byteorder=order, photometric="minisblack")
    tifffile.imwrite(at("f2"), volume("f4").astype("f2"), photometric="minisblack")
    tifffile.imwrite(at("bool"), volume("u1") > 100, photometric="minisblack")
    stack = smooth("u2", (70, 50, 5))
    tifffile.imwrite(at("plain"), stack, photometric="minisblack")
    tifffile.imwrite(at("bigtiff"), stack, bigtiff=True, photometric="minisblack")
    tifffile.imwrite(at("tiles"), stack, tile=(16, 32), photometric="minisblack")
    tifffile.imwrite(at("tiles_zlib"), stack, tile=(32, 16), compression="zlib",
                     photometric="minisblack")
    tifffile.imwrite(at("rows_7"), stack, rowsperstrip=7, photometric="minisblack")
    tifffile.imwrite(at("zlib"), stack, compression="zlib", photometric="minisblack")
    tifffile.imwrite(at("predictor_2"), stack, compression="zlib", predictor=2,
                     photometric="minisblack")
    tifffile.imwrite(at("white_u1"), smooth("u1", (30, 20, 3)), photometric="miniswhite")
    tifffile.imwrite(at("white_u2"), stack, photometric="miniswhite")
    tifffile.imwrite(at("rgb"), volume("u1", (3, 8, 6)), photometric="rgb")
    tifffile.imwrite(at("palette"), volume("u1")[0], photometric="palette",
                     colormap=np.arange(768, dtype="u2").reshape(3, 256))
    for coding in ("lzw", "lzw:2", "packbits", "zip:2", "zstd"):
        subprocess.run(["tiffcp", "-c", coding, at("plain"), at("tiffcp_" + coding.replace(":", "_"))],
                       check=True, capture_output=True)
    subprocess.run(["tiffcp", "-t", "-c", "lzw", at("plain"), at("tiffcp_tiles")], check=True,
                   capture_output=True)
    subprocess.run(["tiffcp", "-f", "lsb2msb", at("bool"), at("tiffcp_lsb2msb")], check=True,
                   capture_output=True)
    hyperstacks(at)


def hyperstacks(at):
    tifffile.imwrite(at("imagej"), volume("u2"), imagej=True, resolution=(2.0, 0.8),
                     metadata={"spacing": 3.0, "unit": "um", "axes": "ZYX"})
    tifffile.imwrite(at("imagej_czt"), volume("u2", (7, 5, 24)).reshape(3, 4, 2, 5, 7), imagej=True,
                     resolution=(2.0, 0.8), metadata={"spacing": 3.0, "unit": "um", "axes": "TZCYX"})
    ome = {"PhysicalSizeX": 0.5, "PhysicalSizeY": 1.25, "PhysicalSizeZ": 3.0}
    tifffile.imwrite(at("plain.ome"), volume("u2"), photometric="minisblack",
                     metadata={"axes": "ZYX", **ome})
    tifffile.imwrite(at("czt.ome"), volume("u2", (7, 5, 24)).reshape(2, 3, 4, 5, 7),
                     photometric="minisblack", metadata={"axes": "CTZYX", **ome})
    tifffile.imwrite(at("tcz.ome"), volume("f4", (7, 5, 24)).reshape(3, 4, 2, 5, 7),
                     photometric="minisblack", metadata={"axes": "TZCYX", **ome})
