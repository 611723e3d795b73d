"""Compares what dump_volume reads with what independent readers do. Run by tests/compare.sh."""

import argparse
import fnmatch
import importlib.util
import json
import os
import shutil
import subprocess
import sys
from collections import Counter
from dataclasses import dataclass

import numpy as np

from volume import Case, Unreadable

MESHES = (".stl", ".off", ".obj", ".ply")
FLIPS = {("LPS", "RAS"): np.diag([-1, -1, 1, 1]), ("RAS", "LPS"): np.diag([-1, -1, 1, 1]),
         ("LPS", "LAS"): np.diag([1, -1, 1, 1]), ("RAS", "LAS"): np.diag([-1, 1, 1, 1])}
SECONDS = 600
SPACING_TOLERANCE = 1e-6
PLACE_TOLERANCE = 1e-4  # of a voxel
FAILURES = ("DIFFERENT", "CRASHED", "UNEXPECTED")


@dataclass
class Row:
    name: str
    format: str
    result: str
    note: str = ""


class Ours:
    """Our reader's program."""

    def __init__(self, program, scratch):
        self.program = program
        self.out = os.path.join(scratch, "ours.raw")
        run = subprocess.run([program, "--formats"], capture_output=True, text=True, check=True)
        self.formats = set(run.stdout.split())

    def open(self, case):
        """(exit status, message). What it wrote is there until the next call."""
        command = [self.program, case.path, "--out", self.out, *case.arguments]
        try:
            run = subprocess.run(command, capture_output=True, text=True, timeout=SECONDS, check=False)
        except subprocess.TimeoutExpired:
            return -1, f"no end within {SECONDS} s"
        return run.returncode, " ".join(run.stderr.split())

    def facts(self):
        with open(self.out + ".json", encoding="utf-8") as file:
            return json.load(file)

    def samples(self, facts):
        return np.memmap(self.out, facts["type"], "r", shape=tuple(facts["size"][::-1]))


def same_samples(ours, theirs):
    """What differs; empty where nothing does. Bits are compared, so NaNs count too."""
    wide = theirs.dtype != ours.dtype
    if wide and not np.can_cast(theirs.dtype, ours.dtype, "safe"):
        return f"type {ours.dtype}, theirs {theirs.dtype}"
    for z in range(ours.shape[0]):
        a = np.ascontiguousarray(ours[z])
        b = np.ascontiguousarray(theirs[z]).astype(ours.dtype)
        if wide and np.array_equal(a, b, equal_nan=a.dtype.kind == "f"):
            continue
        if a.tobytes() == b.tobytes():
            continue
        unlike = np.argwhere(a.view(f"u{a.itemsize}") != b.view(f"u{a.itemsize}"))
        y, x = unlike[0]
        return (f"{len(unlike)} samples of slice {z}, first at x {x}, y {y}: {a[y, x]}, "
                f"theirs {b[y, x]}")
    return ""


def corner_places(affine, size):
    corners = [[x, y, z, 1] for x in (0, size[0] - 1) for y in (0, size[1] - 1) for z in (0, size[2] - 1)]
    return (affine @ np.array(corners, float).T).T[:, :3]


def our_affine(facts):
    affine = np.eye(4)
    for axis in range(3):
        affine[:3, axis] = np.array(facts["direction"][axis]) * facts["spacing"][axis]
    affine[:3, 3] = facts["origin"]
    return affine


def same_places(facts, volume):
    """Spacing, and the world's places of the eight corners."""
    theirs = volume.spacing or (1.0, 1.0, 1.0)
    for axis, (a, b) in enumerate(zip(facts["spacing"], theirs)):
        if b is not None and abs(a - b) > SPACING_TOLERANCE * abs(b):
            return f"spacing {facts['spacing']}, theirs {list(theirs)} (axis {axis})"
    if volume.affine is None:
        return ""
    affine = volume.affine
    if facts["space"] and volume.space and facts["space"] != volume.space:
        pair = (facts["space"], volume.space)
        if pair not in FLIPS:
            return f"world {pair[0]}, theirs {pair[1]}"
        affine = FLIPS[pair] @ affine
    if facts["space"] in ("LPS", "RAS", "LAS") and not volume.space:
        return f"world {facts['space']}, theirs says none"
    size = list(facts["size"])
    if None in theirs:
        size = [1 if b is None else n for n, b in zip(size, theirs)]
    apart = np.abs(corner_places(our_affine(facts), size) - corner_places(affine, size)).max()
    # Positions far from 0 have the digits that doubles give them.
    allowed = PLACE_TOLERANCE * min(facts["spacing"]) + 1e-12 * np.abs(affine[:3, 3]).max()
    if apart > allowed:
        return f"corners are {apart:.6g} apart, of a voxel {apart / min(facts['spacing']):.4g}"
    return ""


def difference(facts, samples, volume):
    if list(volume.samples.shape[::-1]) != facts["size"]:
        return f"size {facts['size']}, theirs {list(volume.samples.shape[::-1])}"
    scale = {key: facts[key] for key in ("slope", "intercept")}
    if scale["slope"] != 1 and volume.slope == 1 and volume.samples.dtype.kind in "ui":
        # VTK writes bytes as text of n / 255, and multiplies by 255 as it reads.
        samples = np.rint(samples * scale["slope"] + scale["intercept"]).astype(volume.samples.dtype)
        scale = {"slope": 1, "intercept": 0}
    found = same_samples(samples, volume.samples) or same_places(facts, volume)
    if found:
        return found
    if volume.unit is not None and facts["unit"] != volume.unit:
        return f"unit '{facts['unit']}', theirs '{volume.unit}'"
    for key in ("slope", "intercept"):
        if not np.isclose(scale[key], getattr(volume, key), rtol=1e-6, atol=1e-12):
            return f"{key} {scale[key]}, theirs {getattr(volume, key)}"
    return ""


def in_child(work):
    """What work returns, of a process of its own: other people's readers may crash."""
    to_read, to_write = os.pipe()
    child = os.fork()
    if child == 0:
        os.close(to_read)
        with os.fdopen(to_write, "w", encoding="utf-8") as pipe:
            json.dump(work(), pipe)
        os._exit(0)
    os.close(to_write)
    with os.fdopen(to_read, encoding="utf-8") as pipe:
        answer = pipe.read()
    _, status = os.waitpid(child, 0)
    if status != 0:
        return "not compared", f"the independent reader died, status {status}"
    return json.loads(answer)


def why_unreadable(case):
    try:
        case.load()
    except Unreadable as error:
        return str(error)
    except Exception:  # pylint: disable=broad-except
        return ""
    return ""


class Expected:
    """Lines "pattern | part of the message | reason"."""

    def __init__(self, path):
        with open(path, encoding="utf-8") as file:
            lines = [line.strip() for line in file if line.strip() and not line.startswith("#")]
        self.rules = [[part.strip() for part in line.split("|", 2)] for line in lines]

    def allows(self, name, message):
        return any(fnmatch.fnmatch(name, "*" + pattern) and part in message
                   for pattern, part, _ in self.rules)


class Comparison:
    def __init__(self, ours, expected, readers, whole):
        """whole: of all formats, so that what none of the readers knows is no format at all."""
        self.ours, self.expected, self.readers, self.whole = ours, expected, readers, whole
        self.rows = []
        self.root = ""

    def add(self, name, kind, result, note=""):
        name = name.replace(self.root, "", 1).lstrip("/") if self.root else name
        if result in ("refused", "not compared") and not self.expected.allows(name, note):
            result, note = "UNEXPECTED", f"{result}: {note}"
        row = Row(name, kind, result, note)
        self.rows.append(row)
        if kind == "unknown" and result == "rightly refused":
            return  # counted, and no more
        print(f"{row.name} | {row.format} | {row.result}{': ' if note else ''}{note}", flush=True)

    def look(self, case, kind):
        code, message = self.ours.open(case)
        name = case.name()
        short = message.replace(case.path + ": ", "").replace(self.root, "")
        if code not in (0, 2):
            self.add(name, kind, "CRASHED", f"exit status {code}: {message[-300:]}")
        elif code == 2 and case.refused:
            self.add(name, kind, "rightly refused", f"{short} [{case.refused}]")
        elif code == 2:
            theirs = in_child(lambda: why_unreadable(case))
            theirs = theirs if isinstance(theirs, str) else ""
            self.add(name, kind, "refused by both" if theirs else "refused",
                     short + (f" [{theirs}]" if theirs else ""))
        elif case.refused:
            self.add(name, kind, "DIFFERENT", f"read, though it is {case.refused}")
        else:
            self.compare(case, kind)

    def compare(self, case, kind):
        self.add(case.name(), kind, *in_child(lambda: self.verdict(case)))

    def verdict(self, case):
        """Result and note."""
        facts = self.ours.facts()
        try:
            volume = case.load()
        except Unreadable as error:
            return "not compared", str(error)
        except Exception as error:  # pylint: disable=broad-except
            return "not compared", f"{type(error).__name__}: {error}"
        found = difference(facts, self.ours.samples(facts), volume)
        if found:
            return "DIFFERENT", found
        shape = "x".join(str(n) for n in facts["size"])
        kept = str(volume.samples.dtype.newbyteorder("="))
        wider = "" if kept == facts["type"] else f", widened from {kept}"
        return "equal", f"{shape} {facts['type']}{wider}"

    def walk(self, path):
        """Every file and folder below, each once."""
        found = next(((reader, f) for reader in self.readers if (f := self.find(reader, path))), None)
        if found is None:
            self.unknown(path)
            return set()
        reader, answer = found
        if reader.ours not in self.ours.formats:
            self.add(path, reader.ours, "no reader of ours")
        else:
            for case in answer.cases:
                self.look(case, reader.ours)
        return {os.path.abspath(part) for part in answer.parts}

    def find(self, reader, path):
        try:
            return reader.find(path)
        except Exception as error:  # pylint: disable=broad-except
            text = f"{reader.ours}: {type(error).__name__}: {error}"

            class Failed:
                cases = [Case(path, lambda: (_ for _ in ()).throw(Unreadable(text)))]
                parts = []
            return Failed

    def unknown(self, path):
        """What no independent reader knows: ours must refuse it, by name."""
        if not self.whole:
            return
        if os.path.isfile(path) and path.lower().endswith(MESHES):
            self.add(path, "mesh", "a mesh", "not compared here")
        elif os.path.isfile(path):
            self.look(Case(path, refused="of no format that is compared"), "unknown")

    def tree(self, folder):
        self.root = os.path.abspath(folder) + "/"
        done = set()
        for here, folders, files in os.walk(os.path.abspath(folder)):
            folders.sort()
            if here != os.path.abspath(folder):
                taken = [r for r in self.readers if self.knows_folder(r, here)]
                if taken:
                    done |= self.walk(here)
                    if getattr(taken[0], "ours", "") in ("zarr", "n5", "dicom", "stack"):
                        folders.clear()
                        continue
            # Headers first: what belongs to them is no input by itself.
            names = sorted(os.path.join(here, f) for f in files)
            heads = [n for n in names if n.lower().endswith((".nhdr", ".mhd", ".hdr", ".hdr.gz"))]
            for name in heads + [n for n in names if n not in heads]:
                if name not in done and not name.endswith(".layout"):
                    done |= self.walk(name)

    def knows_folder(self, reader, path):
        return reader.ours in ("zarr", "n5", "dicom", "stack") and self.find(reader, path)


def usable(readers):
    """Those whose needs are there, and what is missing of the others."""
    missing = {}
    for reader in readers:
        for need, package in reader.needs.items():
            if importlib.util.find_spec(need.split(".")[0]) is None and shutil.which(need) is None:
                missing[need] = package
    ready = [r for r in readers if not set(r.needs) & set(missing)]
    return ready, missing


def print_table(rows):
    total = Counter(row.result for row in rows)
    by_format = Counter((row.format, row.result) for row in rows)
    print("\nformat | result | inputs")
    for (kind, result), count in sorted(by_format.items()):
        print(f"{kind} | {result} | {count}")
    print("\nin all: " + ", ".join(f"{count} {result}" for result, count in sorted(total.items())))
    wrong = [row for row in rows if row.result in FAILURES]
    for row in wrong:
        print(f"{row.result}: {row.name} ({row.format}): {row.note}")
    return 1 if wrong else 0


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--program", required=True)
    parser.add_argument("--scratch", required=True)
    parser.add_argument("--only", default="", help="formats, with commas between them")
    parser.add_argument("folders", nargs="+")
    arguments = parser.parse_args()
    os.environ["VOXWELD_SCRATCH"] = arguments.scratch
    import readers

    wanted = [r for r in readers.ALL if not arguments.only or r.ours in arguments.only.split(",")]
    ready, missing = usable(wanted)
    for need, package in sorted(missing.items()):
        print(f"missing: {need} (Debian: {package}); what needs it is not compared. "
              "tests/compare/install_packages.sh installs it", file=sys.stderr)
    here = os.path.dirname(os.path.abspath(__file__))
    comparison = Comparison(Ours(arguments.program, arguments.scratch),
                            Expected(os.path.join(here, "expected_refusals.txt")), ready,
                            whole=not missing and not arguments.only)
    for folder in arguments.folders:
        comparison.tree(folder)
    status = print_table(comparison.rows)
    return status if not missing or arguments.only else max(status, 3)


if __name__ == "__main__":
    sys.exit(main())
