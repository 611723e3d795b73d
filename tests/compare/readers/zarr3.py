"""Zarr version 3 by zarrita, another reader of the format, run by Node.js."""

import os
import subprocess
import tempfile

import numpy as np

from volume import Case, Found, Unreadable, read_json

from .zarr2 import group_cases, ome_of, placed

ours = "zarr"
needs = {"node": "nodejs"}

SCRIPT = os.path.join(os.path.dirname(os.path.dirname(os.path.abspath(__file__))), "read_zarr3.mjs")


def samples_of(folder):
    with tempfile.TemporaryDirectory() as scratch:
        out = os.path.join(scratch, "samples")
        run = subprocess.run(["node", SCRIPT, os.path.abspath(folder), out], capture_output=True,
                             text=True, check=False)
        if run.returncode != 0:
            lines = run.stderr.strip().splitlines()
            said = [line for line in lines if "Error" in line]
            raise Unreadable("zarrita: " + (said or lines or ["failed"])[0].strip())
        facts = read_json(out + ".json")
        flat = np.fromfile(out, facts["type"])
        steps = [step * flat.itemsize for step in facts["stride"]]
        return np.lib.stride_tricks.as_strided(flat, facts["shape"], steps).copy()


def axes_of(metadata, ome):
    if ome and ome[0]:
        return ome[0]
    names = metadata.get("dimension_names") or []
    known = all(n in ("x", "y", "z", "c", "t") for n in names)
    return list(names) if names and known else []


def array_cases(folder):
    metadata = read_json(os.path.join(folder, "zarr.json"))
    ome = ome_of(folder)
    axes = axes_of(metadata, ome)
    shape = metadata["shape"]
    if len(shape) < 2:
        return [Case(folder, refused=f"{len(shape)} dimensions")]
    names = axes or ["z", "y", "x"][-len(shape):]
    extra = [n for n, size in zip(names, shape) if n not in "zyx" and size > 1]
    if (len(shape) > 3 and not axes) or extra:
        cases = [Case(folder, refused=f"{len(shape)} dimensions")]
        if extra:
            arguments, index = [], []
            for name, size in zip(names, shape):
                chosen = name in extra
                index.append(slice(size - 1, size) if chosen else slice(None))
                if chosen:
                    arguments += ["--channel" if name == "c" else "--time", str(size - 1)]
            cases.append(Case(folder, lambda: placed(samples_of(folder)[tuple(index)], axes, ome),
                              arguments))
        return cases
    return [Case(folder, lambda: placed(samples_of(folder), axes, ome))]


def find(path):
    top = os.path.join(path, "zarr.json")
    if not os.path.isfile(top) or read_json(top).get("zarr_format") != 3:
        return None
    cases = []
    for folder, folders, files in os.walk(path):
        folders.sort()
        if "zarr.json" not in files:
            continue
        if read_json(os.path.join(folder, "zarr.json")).get("node_type") == "array":
            cases += array_cases(folder)
            folders.clear()
        else:
            cases += group_cases(folder, "zarr.json", array_cases)
    return Found(cases)
