"""NRRD by teem, whose format it is: its program rewrites the file raw and little-endian."""

import os
import re
import subprocess
import tempfile

import numpy as np

from volume import Case, Found, Unreadable, Volume, affine_of, head_of

ours = "nrrd"
needs = {"teem-unu": "teem-apps"}

TYPES = {"signed char": "i1", "unsigned char": "u1", "short": "i2", "unsigned short": "u2",
         "int": "i4", "unsigned int": "u4", "long long int": "i8", "unsigned long long int": "u8",
         "float": "f4", "double": "f8", "int8": "i1", "uint8": "u1", "int16": "i2", "uint16": "u2",
         "int32": "i4", "uint32": "u4", "int64": "i8", "uint64": "u8"}
SPACES = {"left-posterior-superior": "LPS", "right-anterior-superior": "RAS",
          "left-anterior-superior": "LAS"}
UNITS = {"millimeter": "mm", "micron": "um"}


def rewritten(path):
    """The header's fields and the samples, as teem understood them."""
    with tempfile.TemporaryDirectory() as folder:
        out = os.path.join(folder, "out.nrrd")
        run = subprocess.run(
            ["teem-unu", "save", "-f", "nrrd", "-e", "raw", "-en", "little", "-i",
             os.path.basename(path), "-o", out],
            cwd=os.path.dirname(path) or ".", capture_output=True, text=True, check=False)
        if run.returncode != 0 or not os.path.exists(out):
            raise Unreadable("teem: " + run.stderr.strip().splitlines()[-1].strip())
        with open(out, "rb") as file:
            text, data = file.read().split(b"\n\n", 1)
    fields = {}
    for line in text.decode("latin-1").splitlines():
        match = re.match(r"([^:#]+): (.*)", line)
        if match:
            fields[match.group(1)] = match.group(2)
    return fields, data


def vectors(text):
    return [None if item == "none" else np.array([float(n) for n in item[1:-1].split(",")][:3])
            for item in re.findall(r"none|\([^)]*\)", text)]


def directions(fields):
    """None where there are none: teem says so for each axis where a header has a space alone."""
    steps = vectors(fields.get("space directions", ""))
    return steps if any(step is not None for step in steps) else None


def spatial_axes(fields, sizes):
    """Those along which samples lie in space. The others have one entry, or it is no volume."""
    kinds = fields.get("kinds", "").split() or ["???"] * len(sizes)
    steps = directions(fields)
    axes = [a for a in range(len(sizes))
            if kinds[a] in ("???", "domain", "space", "none") and (steps is None or steps[a] is not None)]
    while len(axes) > 3 and any(sizes[a] == 1 for a in axes):
        axes.remove(max(a for a in axes if sizes[a] == 1))
    return axes


def geometry(fields, axes):
    steps = directions(fields)
    if steps is not None:
        origin = vectors(fields["space origin"])[0] if "space origin" in fields else np.zeros(3)
        affine = affine_of([steps[a] for a in axes], origin)
        units = re.findall(r'"([^"]*)"', fields.get("space units", ""))
        return {"affine": affine, "spacing": tuple(np.linalg.norm(affine[:3, :3], axis=0)),
                "space": SPACES.get(fields.get("space", ""), ""),
                "unit": UNITS.get(units[0], units[0]) if units else None}
    if "spacings" in fields:
        spacings = [float(n) for n in fields["spacings"].split()]
        # What is not there stands for 1, and a negative one for its magnitude.
        return {"spacing": tuple(abs(spacings[a]) if np.isfinite(spacings[a]) and spacings[a] else 1.0
                                 for a in axes)}
    return {}


def load(fields, data, axes, sizes):
    samples = np.frombuffer(data, "<" + TYPES[fields["type"]]).reshape(sizes[::-1])
    samples = samples.reshape([sizes[a] for a in axes][::-1])
    return Volume(samples, **geometry(fields, axes))


def part_files(path):
    """The data files of a detached header."""
    text = head_of(path, 100_000).split(b"\n\n")[0].decode("latin-1")
    match = re.search(r"^data ?file: ?(.*)$", text, re.MULTILINE)
    if not match:
        return []
    folder = os.path.dirname(path)
    words = match.group(1).split()
    if words[0].startswith("LIST"):
        names = text[match.end():].split("\n")[1:]
    elif "%" in words[0] and len(words) > 3:
        first, last, step = (int(w) for w in words[1:4])
        names = [words[0] % i for i in range(first, last + step, step)]
    else:
        names = [match.group(1).strip()]
    return [os.path.normpath(os.path.join(folder, name)) for name in names if name]


def find(path):
    if not os.path.isfile(path) or not head_of(path, 7).startswith(b"NRRD000"):
        return None

    def open_it():
        fields, data = rewritten(path)
        sizes = [int(n) for n in fields["sizes"].split()]
        axes = spatial_axes(fields, sizes)
        return load(fields, data, axes, sizes)

    case = Case(path, open_it)
    text = head_of(path, 100_000).split(b"\n\n")[0].decode("latin-1")
    match = re.search(r"^sizes: *(.*)$", text, re.MULTILINE)
    sizes = [int(n) for n in match.group(1).split()] if match else []
    if len(sizes) < 3:
        case.refused = f"{len(sizes)} dimensions"
    elif sum(size > 1 for size in sizes) > 3:
        case.refused = "more than 3 dimensions with more than one entry"
    return Found([case], part_files(path))
