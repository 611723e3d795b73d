#!/usr/bin/env python3
"""Writes TIFF files by tifffile and tiffcp, and beside each the samples that must be read from it.

Usage: write_tiffs.py FOLDER [FILES]. With FILES, a folder, links to all that tifffile or, after
tiffcp, tifffile can read of it, instead. Writes FOLDER/cases.txt, one case a line, fields separated by tabs:
  read FILE SAMPLES TYPE X Y Z SPACING [KEY=VALUE]...   SAMPLES: little-endian, x fastest
  refused FILE TEXT [KEY=VALUE]...                      TEXT: what the message says
SPACING is "x y z unit", or "-" where the file does not say. Keys: dataset, channel, time, level.
"""
import ctypes
import ctypes.util
import os
import subprocess
import sys

import numpy
import tifffile

import write_ome_tiffs

folder = sys.argv[1]
cases = []
random = numpy.random.default_rng(5)


def path_of(name):
    return os.path.join(folder, name)


def note(name, samples, spacing="-", **keys):
    """The file holds these samples, axes z, y, x."""
    samples = numpy.asarray(samples)
    if samples.ndim == 2:
        samples = samples[None]
    if samples.dtype == numpy.float16:
        samples = samples.astype("f4")
    raw = f"{len(cases)}.raw"
    samples.astype(samples.dtype.newbyteorder("<")).tofile(path_of(raw))
    kind = {"u": "uint", "i": "int", "f": "float"}[samples.dtype.kind] + str(8 * samples.itemsize)
    z, y, x = samples.shape
    cases.append(["read", name, raw, kind, str(x), str(y), str(z), spacing]
                 + [f"{key}={value}" for key, value in keys.items()])


def refuse(name, text, **keys):
    cases.append(["refused", name, text] + [f"{key}={value}" for key, value in keys.items()])


def some(shape, dtype):
    dtype = numpy.dtype(dtype)
    if dtype.kind == "f":
        return (random.integers(-2000, 2000, shape) / 8).astype(dtype)
    ends = numpy.iinfo(dtype)
    return random.integers(ends.min, ends.max, shape, dtype=dtype, endpoint=True)


def write(name, data, **options):
    tifffile.imwrite(path_of(name), data, **options)


def tiffcp(source, target, *options):
    done = subprocess.run(["tiffcp", *options, path_of(source), path_of(target)],
                          capture_output=True, text=True, check=False)
    return done.returncode == 0


def storages():
    """Every type in every storage."""
    for dtype in ("u1", "i1", "u2", "i2", "u4", "i4", "u8", "i8", "f2", "f4", "f8"):
        data = some((3, 37, 53), dtype)
        for order in "<>":
            for big in (False, True):
                name = f"{dtype}-{'le' if order == '<' else 'be'}{'-big' if big else ''}"
                options = {"byteorder": order, "bigtiff": big, "photometric": "minisblack",
                           "metadata": None}
                write(name + ".tif", data, rowsperstrip=10, **options)
                note(name + ".tif", data)
                write(name + "-tiles.tif", data, tile=(16, 32), **options)
                note(name + "-tiles.tif", data)
                write(name + "-zip.tif", data, compression="zlib", rowsperstrip=7, **options)
                note(name + "-zip.tif", data)
        integer = dtype[0] != "f"
        codecs = ["lzw", "zip", "packbits", "zstd", "lzma", "none"]
        codecs += ["lzw:2", "zip:2", "zstd:2"] if integer else ["lzw:3", "zip:3", "zstd:3"]
        for codec in codecs:
            for more in ([], ["-t", "-w", "32", "-l", "16"], ["-B", "-r", "5"],
                         ["-8", "-B", "-t", "-w", "16", "-l", "48"], ["-f", "lsb2msb", "-r", "9"]):
                if codec.endswith("3") and "-B" in more:
                    continue  # tiffcp writes these with the bytes of each sample reversed
                name = f"{dtype}-{codec.replace(':', '')}{''.join(more)}.tif"
                if tiffcp(f"{dtype}-le.tif", name, "-c", codec, *more):
                    note(name, data)


def depths():
    """Masks and floats of 24 bits."""
    mask = random.integers(0, 2, (2, 20, 21)).astype(bool)
    write("mask.tif", mask, photometric="minisblack", metadata=None)
    note("mask.tif", mask.astype("u1"))
    for codec in ("g3", "g4", "packbits", "lzw"):
        if tiffcp("mask.tif", f"mask-{codec}.tif", "-c", codec):
            note(f"mask-{codec}.tif", mask.astype("u1"))
    smooth = numpy.add.outer(numpy.arange(64), numpy.arange(80)).astype("u1")
    write("smooth.tif", smooth, photometric="minisblack", metadata=None)
    for name, more in (("jpeg.tif", []), ("jpeg-tiles.tif", ["-t", "-w", "32", "-l", "32"])):
        if tiffcp("smooth.tif", name, "-c", "jpeg", *more):
            tiffcp(name, "plain-" + name, "-c", "none", "-s")
            note(name, tifffile.imread(path_of("plain-" + name)))
    write("complex.tif", numpy.ones((10, 12), "c8"), photometric="minisblack", metadata=None)
    refuse("complex.tif", "64 bits of complex numbers")


def by_libtiff():
    """Compressions that tiffcp has no option for, at no loss."""
    library = ctypes.util.find_library("tiff")
    if library is None:
        return
    tiff = ctypes.CDLL(library)
    tiff.TIFFOpen.restype = ctypes.c_void_p
    lerc = 34887
    if tiff.TIFFIsCODECConfigured(lerc) == 0:
        return
    for dtype in ("u1", "i2", "u2", "i4", "f4", "f8"):
        data = numpy.ascontiguousarray(some((40, 33), dtype))
        name = f"{dtype}-lerc.tif"
        file = ctypes.c_void_p(tiff.TIFFOpen(path_of(name).encode(), b"w"))
        form = {"u": 1, "i": 2, "f": 3}[dtype[0]]
        for tag, value in ((256, 33), (257, 40), (258, 8 * data.itemsize), (277, 1), (339, form),
                           (262, 1), (278, 40), (259, lerc)):
            tiff.TIFFSetField(file, ctypes.c_uint32(tag), ctypes.c_int(value))
        tiff.TIFFWriteEncodedStrip(file, ctypes.c_uint32(0), data.ctypes.data_as(ctypes.c_void_p),
                                   ctypes.c_ssize_t(data.nbytes))
        tiff.TIFFClose(file)
        note(name, data)


def colours():
    """Several samples a pixel, and palettes."""
    data = some((2, 19, 23, 3), "u2")
    for planar in ("contig", "separate"):
        stored = data if planar == "contig" else numpy.moveaxis(data, 3, 1)
        write(f"rgb-{planar}.tif", stored, photometric="rgb", planarconfig=planar, metadata=None)
        refuse(f"rgb-{planar}.tif", "has 3 channels: 0 (red), 1 (green), 2 (blue)")
        refuse(f"rgb-{planar}.tif", "input.channel (--channel) is 3", channel=3)
        names = [f"rgb-{planar}.tif", f"rgb-{planar}-tiles.tif"]
        write(names[1], stored, photometric="rgb", planarconfig=planar, metadata=None,
              tile=(16, 16), compression="zlib")
        for i, more in enumerate((["-c", "lzw", "-r", "5"], ["-c", "zip:2", "-p", "separate"],
                                  ["-c", "zip:2", "-p", "contig"])):
            if tiffcp(f"rgb-{planar}.tif", f"rgb-{planar}-{i}.tif", *more):
                names.append(f"rgb-{planar}-{i}.tif")
        for name in names:
            for channel in range(3):
                note(name, data[..., channel], channel=channel)
    alpha = some((15, 16, 2), "f4")
    write("alpha.tif", alpha, photometric="minisblack", extrasamples=["unassalpha"],
          planarconfig="contig", metadata=None)
    refuse("alpha.tif", "0 (grey), 1 (alpha)")
    note("alpha.tif", alpha[..., 0], channel=0)
    index = some((14, 9), "u1")
    write("palette.tif", index, photometric="palette", metadata=None,
          colormap=some((3, 256), "u2"))
    note("palette.tif", index)
    wide = some((14, 9), "u2")
    write("palette16.tif", wide, photometric="palette", metadata=None,
          colormap=some((3, 65536), "u2"))
    note("palette16.tif", wide)


def write_plain(name, planes, description, **options):
    """Pages one behind the other, with a description of our own on the first."""
    with tifffile.TiffWriter(path_of(name), **options) as out:
        for i, plane in enumerate(planes):
            out.write(plane, photometric="minisblack", metadata=None, contiguous=False,
                      description=description if i == 0 else None)


def imagej():
    data = some((2, 4, 3, 11, 13), "u2")  # t z c y x
    write("hyper.tif", data, imagej=True, resolution=(4, 4),
          metadata={"axes": "TZCYX", "spacing": 2.5, "unit": "um"})
    refuse("hyper.tif", "has 3 channels: 0, 1, 2")
    refuse("hyper.tif", "has 2 times", channel=1)
    for t in range(2):
        for c in range(3):
            note("hyper.tif", data[t, :, c], "0.25 0.25 2.5 um", channel=c, time=t)
    frames = data[:, 0, 0]
    write("frames.tif", frames, imagej=True, metadata={"axes": "TYX"})
    note("frames.tif", frames)
    note("frames.tif", frames[1], time=1)
    rgb = some((3, 8, 9, 3), "u1")
    write("imagej-rgb.tif", rgb, imagej=True, metadata={"axes": "ZYXS"})
    note("imagej-rgb.tif", rgb[..., 1], channel=1)
    planes = data[0].reshape(-1, 11, 13)
    text = "ImageJ=1.53t\nimages=12\nchannels=3\nslices=4\nhyperstack=true\n"
    for order in "<>":
        name = f"one-directory-{'le' if order == '<' else 'be'}.tif"
        write_plain(name, planes[:1], text, byteorder=order)
        with tifffile.TiffFile(path_of(name)) as tif:
            start = tif.pages[0].dataoffsets[0]
        # Moved to where all images have room.
        with open(path_of(name), "r+b") as out:
            raw = out.read()
            out.seek(0, os.SEEK_END)
            end = out.tell()
            out.write(planes.astype(planes.dtype.newbyteorder(order)).tobytes())
            size = 4
            code = "little" if order == "<" else "big"
            at = raw.rfind(start.to_bytes(size, code))
            out.seek(at)
            out.write(end.to_bytes(size, code))
        for c in range(3):
            note(name, data[0, :, c], channel=c)
        with open(path_of(name), "rb") as whole, open(path_of("cut-" + name), "wb") as cut:
            cut.write(whole.read()[:-1])
        refuse("cut-" + name, "has room for 11", channel=0)
    write_plain("contradiction.tif", planes[:6], text.replace("images=12", "images=6"))
    refuse("contradiction.tif", "says 6 images, but 3 channels, 4 slices and 1 frames")
    write_plain("short.tif", planes[:6], text)
    refuse("short.tif", "has 6 pages, but the description of ImageJ says 12 images")


def turned(page):
    data = page.asarray()
    if data.dtype == bool:
        data = data.astype("u1")
    if page.photometric == 0 and data.dtype.kind == "u":
        data = ((1 << page.bitspersample) - 1 - data.astype("i8")).astype(data.dtype)
    return data


def stack_in(path):
    """The pages as they are stored, each that is white-is-zero turned; axes z, y, x, sample."""
    with tifffile.TiffFile(path) as file:
        pages = [turned(page) for page in file.pages]
        page = file.pages[0]
        planar = page.samplesperpixel > 1 and page.planarconfig == 2
        data = numpy.stack(pages)
        if planar:
            data = numpy.moveaxis(data, 1, -1)
        if page.samplesperpixel == 1:
            data = data[..., None]
        return data


def files_of(top):
    for where, _, names in sorted(os.walk(top)):
        for name in sorted(names):
            if not name.lower().endswith((".tif", ".tiff", ".btf", ".tf8")):
                continue
            link = f"{len(cases)}-{name}"
            os.symlink(os.path.join(where, name), path_of(link))
            data = None
            for source in (link, "plain.tif"):
                try:
                    if source != link and not tiffcp(link, source, "-c", "none"):
                        break
                    data = stack_in(path_of(source))
                    break
                except Exception:  # pylint: disable=broad-except
                    continue
            with tifffile.TiffFile(path_of(link)) as file:
                if len({page.photometric == 0 for page in file.pages}) > 1:
                    refuse(link, "white is zero); expected")
                    continue
                if file.pages[0].photometric in (32844, 32845):
                    refuse(link, "LogL or LogLuv are not supported")
                    continue
            if data is None:
                print("not read by tifffile:", name)
                continue
            for channel in range(data.shape[-1]):
                keys = {"channel": channel} if data.shape[-1] > 1 else {}
                note(link, data[..., channel], **keys)


def note_cases():
    with open(path_of("cases.txt"), "w", encoding="utf-8") as out:
        for case in cases:
            out.write("\t".join(case) + "\n")


if __name__ == "__main__":
    if len(sys.argv) > 2:
        files_of(sys.argv[2])
    else:
        storages()
        depths()
        by_libtiff()
        colours()
        imagej()
        write_ome_tiffs.write_all(sys.modules[__name__])
    note_cases()
