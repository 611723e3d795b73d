#!/usr/bin/env python3
"""Runs of random volumes with random settings, each cut in several ways that must not matter.

usage: random_runs.py PROGRAM [--from N] [--count N] [--keep FOLDER]
PROGRAM is build/voxweld. N: the number of the first run (0), and how many (100). What a run is depends on
its number alone. --keep: where volume, config and outputs of what failed are left
(build/random_runs).

A run fails where the program does, where two ways give other bytes, where `voxweld verify` finds a fault or
a triangle without an area, or where the manifest has another number of pairs of triangles that intersect
(with refine off, of triangles without an area).
Prints a line a run: what it says, the run's number, triangles, pairs before and after refine, kind of volume and
settings. Exit code 1 where one has failed.
"""
import argparse
import contextlib
import hashlib
import json
import pathlib
import random
import shutil
import subprocess
import sys
import tempfile

PHANTOMS = ["porous", "porous", "gyroid", "part", "noise"]
LABELS = ["labels", "junctions", "noisy labels"]
SPACINGS = [[1, 1, 1], [1, 1, 1], [0.7, 1, 2.1], [0.3, 0.3, 0.31], [12.5, 12.5, 40], [0.9985] * 3]
WAYS = [
    {"work.brick": 16, "work.shard": 2, "run.threads": 1},
    {"work.brick": 64, "work.shard": 1, "run.threads": 3, "work.chunk": 16},
    {"work.brick": 32, "work.shard": 1, "run.threads": 2, "work.copy": True},
]
SIDE_EFFECTS = ["manifest.json", "report.html", "voxweld.lock"]  # have times and hosts in them


class Failure(Exception):
    pass


def call(program, *arguments):
    done = subprocess.run([program, *arguments], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        said = (done.stderr.strip() or done.stdout.strip()).splitlines()
        raise Failure(f"{arguments[0]} ends with {done.returncode}: {said[-1] if said else ''}")
    return done.stdout


def as_option(value):
    return json.dumps(value) if not isinstance(value, str) else value


def options(settings):
    return [word for key, value in settings.items() for word in ("--set", f"{key}={as_option(value)}")]


def write_noisy_labels(path, sizes, lot):
    labels = lot.randint(2, 5)
    voxels = bytes(lot.randrange(labels) for _ in range(sizes[0] * sizes[1] * sizes[2]))
    head = "NRRD0004\ntype: uint8\ndimension: 3\nsizes: {} {} {}\nencoding: raw\n\n".format(*sizes)
    path.write_bytes(head.encode() + voxels)


def write_volume(program, kind, number, lot):
    """Writes volume.nrrd and returns its sides."""
    if kind == "noisy labels":
        sizes = [lot.randint(8, 20) for _ in range(3)]
        write_noisy_labels(pathlib.Path("volume.nrrd"), sizes, lot)
        return sizes
    side = lot.randint(10, 22) if kind == "noise" else lot.randint(24, 56)
    sample = "uint16" if kind in LABELS else lot.choice(["uint8", "float32"])
    seed = ["--seed", str(number + 1)] if kind in ("porous", "noise", "labels") else []
    call(program, "phantom", kind, "--size", str(side), "--type", sample, "-o", "volume.nrrd", "--force", *seed)
    return [side] * 3


def random_crop(sizes, lot):
    low = [lot.randint(0, side // 3) for side in sizes]
    return low + [lot.randint(side // 2 + 2, side) for side in sizes]


def random_edit(sizes, spacing, lot, with_materials):
    """In the output's coordinates."""
    sides = [side * apart for side, apart in zip(sizes, spacing)]
    middle = [round(side * lot.uniform(0.2, 0.8), 3) for side in sides]
    if lot.random() < 0.5:
        shape = f'shape = "sphere"\nradius = {lot.uniform(0.1, 0.4) * min(sides):.3f}\n'
    else:
        edges = [round(lot.uniform(0.1, 0.6) * side, 3) for side in sides]
        turns = [lot.randrange(90) for _ in range(3)]
        shape = f'shape = "box"\nsize = {edges}\nrotate = {turns}\n'
    op = lot.choice(["add", "subtract"])
    material = f"material = {lot.randint(1, 9)}\n" if with_materials and op == "add" else ""
    return f'[[edit]]\nop = "{op}"\ncenter = {middle}\n{shape}{material}'


def random_settings(kind, lot):
    refine = lot.choice(["repair", "collapse", "collapse", "off"])
    settings = {
        "simplify.tolerance": lot.choice([0.05, 0.1, 0.3, 1, 1e9]),
        "simplify.refine": refine,
        "surface.border": lot.choice(["open", "closed"]),
        "output.tile_vertices": lot.choice([1024, 1024, 3000, 250000]),
        "output.normals": lot.choice([True, False]),
    }
    if refine == "collapse" and lot.random() < 0.15:
        settings["simplify.ratio"] = lot.choice([0.2, 0.5])
    if kind in LABELS:
        settings["labels.mode"] = lot.choice(["each", "shared"])
    elif lot.random() < 0.1:
        settings["simplify.topology"] = lot.choice(["safe", "free"] if refine == "off" else ["safe"])
    if refine != "off" and settings.get("labels.mode") != "each" and lot.random() < 0.4:
        settings["output.levels"] = lot.choice([2, 3, '"auto"'])
    if lot.random() < 0.1:
        settings["simplify.enabled"] = False
    return settings | rare_settings(kind, lot)


def rare_settings(kind, lot):
    settings = {}
    if lot.random() < 0.4:
        settings["output.precision"] = lot.choice([0.25, 0.1, 0.003])
    if lot.random() < 0.2:
        settings["simplify.metric"] = "sum"
    if lot.random() < 0.2:
        settings["surface.gradient"] = "central"
    if kind not in LABELS and lot.random() < 0.3:
        settings["surface.inside"] = lot.choice(["above", "below"])
    return settings


def tree_hash(folder):
    total = hashlib.sha256()
    for path in sorted(folder.rglob("*")):
        if path.is_file() and path.name not in SIDE_EFFECTS:
            total.update(str(path.relative_to(folder)).encode() + b"\0" + path.read_bytes())
    return total.hexdigest()


def check_mesh(program, output, settings):
    """Returns triangles and pairs, as a text."""
    verified = json.loads(call(program, "verify", str(output), "--no-origin", "--intersections", "--json"))
    manifest = json.loads((output / "manifest.json").read_text())
    refine = manifest.get("refine", {})
    if verified["degenerate_triangles"] > (0 if refine else manifest["counts"]["collinear"]):
        raise Failure(f"{verified['degenerate_triangles']} triangles have no area")
    left = refine.get("intersecting_left")
    # Meshes of labels lie on each other, and verify looks at all of them together.
    if left is not None and settings.get("labels.mode") != "each" and left != verified["intersecting_pairs"]:
        raise Failure(f"{verified['intersecting_pairs']} pairs intersect; the manifest says {left}")
    return f"{verified['triangles']:7d} {refine.get('intersecting_before', 0):5d} {left or 0:2d}"


def one_run(program, number):
    """Returns what to print of it: whether it failed, and the text."""
    lot = random.Random(number)
    kind = lot.choice(PHANTOMS + LABELS)
    sizes = write_volume(program, kind, number, lot)
    spacing = lot.choice(SPACINGS)
    config = f'[input]\npath = "volume.nrrd"\nspacing = {spacing}\n'
    if lot.random() < 0.4:
        config += f"crop = {random_crop(sizes, lot)}\n"
    if kind not in LABELS:
        config += '[surface]\nisovalue = "otsu"\n'
    settings = random_settings(kind, lot)
    if lot.random() < 0.15:
        for _ in range(lot.randint(1, 3)):
            config += random_edit(sizes, spacing, lot, kind in LABELS)
    pathlib.Path("config.toml").write_text(config)
    said = f"{kind}: " + " ".join(options(settings)[1::2])
    said += " crop" * ("crop" in config) + " edit" * config.count("[[edit]]")
    try:
        hashes = set()
        for way in lot.sample(WAYS, lot.choice([2, 2, 3])):
            output = pathlib.Path(f"mesh{len(hashes)}")
            shutil.rmtree("work", ignore_errors=True)
            shutil.rmtree(output, ignore_errors=True)
            where = {"work.directory": "work", "output.directory": str(output), "output.report": False}
            call(program, "run", "config.toml", "--log-level", "warning", *options({**settings, **where, **way}))
            hashes.add(tree_hash(output))
            if len(hashes) > 1:
                raise Failure(f"other bytes where {way}")
        return False, f"good {number:5d} {check_mesh(program, pathlib.Path('mesh0'), settings)} {said}"
    except Failure as failure:
        # Of what has no surface, or one that is gone at a large tolerance, there is nothing to look at.
        if "no surface" in str(failure) or "it has no triangles" in str(failure):
            return False, f"none {number:5d} {said}"
        return True, f"FAILED {number:5d} {said}\n  {failure}"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("--from", type=int, default=0, dest="first")
    parser.add_argument("--count", type=int, default=100)
    parser.add_argument("--keep", type=pathlib.Path)
    given = parser.parse_args()
    program = given.program.resolve()
    keep = (given.keep or program.parent / "random_runs").resolve()
    failures = 0
    for number in range(given.first, given.first + given.count):
        with tempfile.TemporaryDirectory(prefix="voxweld-random-") as folder:
            with contextlib.chdir(folder):
                failed, text = one_run(program, number)
            print(text, flush=True)
            if failed:
                failures += 1
                shutil.copytree(folder, keep / str(number), dirs_exist_ok=True)
    if failures:
        sys.exit(f"{failures} of {given.count} runs have failed; what is left of them is in {keep}")


if __name__ == "__main__":
    main()
