"""Images and stacks of them by tifffile and Pillow; libtiff's tiffcp undoes compressions that
tifffile does not know."""

import os
import re
import subprocess
import tempfile

import numpy as np

from volume import IMAGE_ENDINGS, Case, Found, Unreadable, Volume, diagonal, native

ours = "stack"
needs = {"tifffile": "python3-tifffile", "PIL": "python3-pil", "tiffcp": "libtiff-tools"}


def unpacked_bits(page):
    """Uncompressed samples of a number of bits that tifffile leaves to others: rows begin at whole
    bytes, the highest bit comes first, whatever the order of bytes."""
    file = page.parent.filehandle
    data = b""
    for offset, count in zip(page.dataoffsets, page.databytecounts):
        file.seek(offset)
        data += file.read(count)
    bits = page.bitspersample
    height, width = page.shape[:2]
    rows = np.frombuffer(data, "u1").reshape(height, -1)
    every = np.unpackbits(rows, axis=1, bitorder="little" if page.fillorder == 2 else "big")
    every = every[:, : width * bits].reshape(height, width, bits).astype("u4")
    values = (every << np.arange(bits - 1, -1, -1, dtype="u4")).sum(axis=2, dtype="u4")
    return values.astype("u1" if bits <= 8 else "u2" if bits <= 16 else "u4")


def page_samples(page):
    try:
        return page.asarray()
    except Exception as error:
        if page.compression != 1 or page.samplesperpixel != 1 or "packints" not in str(error):
            raise
        return unpacked_bits(page)


def tiff_pages(path):
    """Pages as stored, [page, y, x, ...], and what the first says of itself."""
    import tifffile

    with tifffile.TiffFile(path) as file:
        first = file.pages[0]
        try:
            return np.stack([page_samples(page) for page in file.pages]), first
        except Exception:  # pylint: disable=broad-except
            pass
    with tempfile.TemporaryDirectory() as folder:
        plain = os.path.join(folder, "plain.tif")
        run = subprocess.run(["tiffcp", "-c", "none", path, plain], capture_output=True, text=True,
                             check=False)
        if run.returncode != 0:
            raise Unreadable("libtiff: " + run.stderr.strip().splitlines()[-1])
        with tifffile.TiffFile(plain) as file:
            try:
                return np.stack([page_samples(page) for page in file.pages]), first
            except Exception as error:
                raise Unreadable(f"tifffile: {error}") from error


def upright(samples, page):
    """Values as brightness: where white is zero they are turned."""
    bits = page.bitspersample if isinstance(page.bitspersample, int) else page.bitspersample[0]
    if samples.dtype == bool:
        samples = samples.astype(np.uint8)
    if page.photometric == 0 and samples.dtype.kind in "ui":
        top = (1 << bits) - 1 if samples.dtype.kind == "u" else -1
        return (top - samples.astype(np.int64)).astype(samples.dtype)
    return samples


def calibration(page):
    """ImageJ's or OME's spacing, where all three axes have one."""
    text = page.description or ""
    if text.startswith("ImageJ="):
        values = dict(line.split("=", 1) for line in text.splitlines() if "=" in line)
        tags = [page.tags.get(code) for code in (282, 283)]
        if "spacing" in values and all(tags):
            return tuple(t.value[1] / t.value[0] for t in tags) + (abs(float(values["spacing"])),)
    found = re.search(r"<Pixels[^>]*>", text)
    if found:
        sizes = [re.search(rf'PhysicalSize{axis}="([^"]*)"', found.group(0)) for axis in "XYZ"]
        if all(sizes):
            return tuple(float(s.group(1)) for s in sizes)
    return None


def why_not(page, pages):
    if page.samplesperpixel > 1:
        return f"{page.samplesperpixel} values a pixel"
    if pages.ndim != 3:
        return "more than 3 dimensions"
    return ""


def load_tiff(path):
    pages, page = tiff_pages(path)
    spacing = calibration(page)
    return Volume(native(upright(pages, page)), spacing,
                  diagonal(spacing, (0, 0, 0)) if spacing else None)


def order_of(page, text):
    """OME: sizes and order of channels, times and slices of one file. ImageJ: the same."""
    found = re.search(r"<Pixels[^>]*>", text)
    if found:
        sizes = {a: int(re.search(rf'Size{a}="(\d+)"', found.group(0)).group(1)) for a in "CTZ"}
        order = re.search(r'DimensionOrder="XY(\w+)"', found.group(0)).group(1)
        return sizes, order
    if text.startswith("ImageJ="):
        values = dict(line.split("=", 1) for line in text.splitlines() if "=" in line)
        sizes = {a: int(values.get(k, 1)) for a, k in (("C", "channels"), ("Z", "slices"),
                                                       ("T", "frames"))}
        return sizes, "CZT"
    return None, ""


def hyperstack_cases(path, page):
    """Channels and times, one by one."""
    sizes, order = order_of(page, page.description or "")
    if not sizes or (sizes["C"] == 1 and (sizes["T"] == 1 or sizes["Z"] == 1)):
        return []
    cases = [Case(path, refused=f"{sizes['C']} channels, {sizes['T']} times and no choice")]

    def chosen(c, t):
        volume = load_tiff(path)
        shape = [sizes[a] for a in order[::-1]] + list(volume.samples.shape[1:])
        stack = volume.samples.reshape(shape)
        at = {"C": c, "T": t}
        volume.samples = stack[tuple(at.get(a, slice(None)) for a in order[::-1])]
        return volume

    for c, t in {(0, 0), (sizes["C"] - 1, sizes["T"] - 1)}:
        arguments = (["--channel", str(c)] if sizes["C"] > 1 else []) + (
            ["--time", str(t)] if sizes["T"] > 1 else [])
        cases.append(Case(path, lambda c=c, t=t: chosen(c, t), arguments))
    return cases


def load_picture(path):
    from PIL import Image

    if path.lower().endswith(".pgm"):
        return load_pgm(path)
    with Image.open(path) as image:
        # Black and white are the ends of the range.
        samples = np.asarray(image.convert("L") if image.mode == "1" else image)
        # Pillow holds 16 bits in 32.
        return samples.astype("u2") if image.mode == "I" and path.lower().endswith(".png") else samples


def load_pgm(path):
    """As stored: Pillow stretches values to the range of the type."""
    with open(path, "rb") as file:
        data = file.read()
    head = re.match(rb"P5\s+(?:#.*\n\s*)*(\d+)\s+(\d+)\s+(\d+)\s", data)
    if head is None:
        raise Unreadable("no binary PGM")
    width, height, top = (int(n) for n in head.groups())
    samples = np.frombuffer(data, ">u2" if top > 255 else "u1", width * height, head.end())
    return samples.reshape(height, width)


def one_file(path):
    if not path.lower().endswith((".tif", ".tiff")):
        image = load_picture(path)
        if image.ndim != 2:
            return Found([Case(path, refused="colours")])
        return Found([Case(path, lambda: Volume(native(image[np.newaxis])))])
    import tifffile

    with tifffile.TiffFile(path) as file:
        page = file.pages[0]
        count = len(file.pages)
        cases = hyperstack_cases(path, page)
        if cases:
            return Found(cases)
        why = why_not(page, np.empty((count, 1, 1)))
        if not why and any(other.shape != page.shape for other in file.pages):
            why = "pages of several sizes"
    return Found([Case(path, refused=why) if why else Case(path, lambda: load_tiff(path))])


def number_of(name):
    return int(re.findall(r"\d+", name)[-1])


def load_folder(path, names):
    slices = []
    for name in names:
        full = os.path.join(path, name)
        if name.lower().endswith((".tif", ".tiff")):
            pages, page = tiff_pages(full)
            slices.append(upright(pages, page)[0])
        else:
            slices.append(load_picture(full))
    return Volume(native(np.stack(slices)))


def find(path):
    if os.path.isfile(path):
        return one_file(path) if path.lower().endswith(IMAGE_ENDINGS) else None
    names = sorted(n for n in os.listdir(path) if not n.startswith("."))
    images = [n for n in names if n.lower().endswith(IMAGE_ENDINGS)]
    alike = {re.sub(r"\d+(?=\D*$)", "#", n) for n in images}
    if len(images) < 2 or len(images) != len(names) or len(alike) != 1:
        return None
    images.sort(key=number_of)
    return Found([Case(path, lambda: load_folder(path, images))],
                 [os.path.join(path, n) for n in names])
