#!/usr/bin/python3
"""How many triangles buy which accuracy: voxweld and other programs over their settings.

Makes phantoms, and takes a scan where there is one, makes meshes of each with every program and
setting below, measures all of them with measure_output, and writes a JSON file and a picture. What
the JSON file has already is not done again; a program that is not installed is skipped. `--draw`
draws the picture again and runs nothing.
"""
import argparse
import dataclasses
import json
import lzma
import pathlib
import shutil
import subprocess
import sys
import tempfile
import time

from phantom_measures import (
    BY_REFERENCE,
    PHANTOMS,
    Failed,
    fine_mesh,
    has_peer,
    measure,
    peer,
    run,
    surface_of,
)

HERE = pathlib.Path(__file__).resolve().parent
VOLUMES = [*PHANTOMS, "bunny"]


@dataclasses.dataclass
class Variant:
    """Keys of the config, with the values they get. Where voxweld does not know what is needed, the
    variant is skipped; what is not needed is left out."""

    needed: dict = dataclasses.field(default_factory=dict)
    if_known: dict = dataclasses.field(default_factory=dict)


VARIANTS = {
    "octree": Variant(if_known={"simplify.refine": "off"}),
    "refine": Variant(needed={"simplify.refine": "collapse"}),
}
TOLERANCES = [0.02, 0.05, 0.1, 0.2, 0.4, 0.8]
ADAPTIVITIES = [0, 0.01, 0.03, 0.1, 0.3, 1]
# Of the triangles of FlyingEdges.
SHARES = [0.5, 0.25, 0.1, 0.05, 0.02]


class Bench:
    """The folder with volumes, meshes in work, and the figures."""

    def __init__(self, arguments, folder):
        self.build, self.size = arguments.build.resolve(), arguments.size
        self.folder, self.figures = folder, arguments.output
        self.records = (
            json.loads(self.figures.read_text())["records"] if self.figures.exists() else []
        )
        self.records = [r for r in self.records if r["program"] not in arguments.again]
        self.bunny, self.skipped = arguments.bunny, arguments.skip

    def has(self, volume, program, setting):
        return any(
            (r["volume"], r["size"], r["program"], r["setting"])
            == (volume, self.size, program, setting)
            for r in self.records
        )

    def volume(self, name):
        path = self.folder / f"{name}-{self.size}.nrrd"
        if path.exists():
            return path
        if name == "bunny":
            part = path.with_name("part.nrrd")
            write_bunny(self.bunny, self.size, part)
            part.replace(path)
        else:
            run(self.build / "voxweld", "phantom", name, "--size", self.size, "-o", path)
        return path

    def flying_edges(self, name):
        """The mesh at full resolution, and the seconds it took."""
        path = self.folder / f"{name}-{self.size}.full.ply"
        seconds = path.with_suffix(".seconds")
        if not seconds.exists():
            seconds.write_text(peer("flying_edges", self.volume(name), path, "-"))
        return path, float(seconds.read_text())

    def fine(self, name):
        return fine_mesh(self.volume(name), self.folder / f"{name}-{self.size}.fine.ply")

    def measure(self, name, mesh):
        fine = self.fine(name) if name in BY_REFERENCE else None
        return measure(self.build / "measure_output", mesh, name, self.size, fine)

    def note(self, volume, program, setting, make):
        """make() gives a mesh and the seconds it took."""
        if program in self.skipped or self.has(volume, program, setting):
            return
        what = f"{volume} {self.size}, {program} {setting}"
        try:
            mesh, seconds = make()
            record = {
                "volume": volume,
                "size": self.size,
                "program": program,
                "setting": setting,
                "seconds": round(seconds, 3),
                **self.measure(volume, mesh),
            }
        except Failed as problem:
            print(f"{what}: failed: {problem}", flush=True)
            return
        self.records.append(record)
        part = self.figures.with_name(self.figures.name + ".part")
        part.write_text(json.dumps({"records": self.records}, indent=1) + "\n")
        part.replace(self.figures)
        distances = record["mesh_to_surface"]
        print(
            f"{what}: {record['triangles']} triangles, mean {distances['mean']:.4f}, "
            f"p99 {distances['p99']:.3f}, {record['seconds']} s",
            flush=True,
        )


def write_bunny(packed, size, path):
    """The middle of the scan, at most size samples a side, as if its voxels were cubes. Its
    outermost samples become air, so that every program closes the surface there."""
    import numpy as np

    isovalue, air = 1150.5, 0
    with lzma.open(packed) as file:
        samples = np.frombuffer(file.read(), ">i2").reshape(361, 512, 512)
    cut = tuple(slice((n - min(n, size)) // 2, (n + min(n, size)) // 2) for n in samples.shape)
    samples = samples[cut].astype("<i2")
    for axis in range(3):
        ends = [slice(None)] * 3
        for ends[axis] in (0, -1):
            samples[tuple(ends)] = air
    with open(path, "wb") as file:
        sizes = " ".join(str(n) for n in reversed(samples.shape))
        file.write(
            f"NRRD0004\n# isovalue {isovalue}, inside above\ntype: int16\ndimension: 3\n"
            f"sizes: {sizes}\nendian: little\nencoding: raw\n\n".encode()
        )
        samples.tofile(file)


def knows(voxweld, key, value):
    result = subprocess.run([voxweld, "settings", key], capture_output=True, text=True)
    return result.returncode == 0 and f'"{value}"' in result.stdout


def run_voxweld(bench, volume, settings):
    for made in ("run.work", "run.mesh"):
        shutil.rmtree(bench.folder / made, ignore_errors=True)
    isovalue, inside = surface_of(bench.volume(volume))
    config = bench.folder / "run.toml"
    config.write_text(
        f'[input]\npath = "{bench.volume(volume)}"\n[surface]\nisovalue = {isovalue}\n'
        f'inside = "{inside}"\n'
    )
    sets = [word for key, value in settings.items() for word in ("--set", f"{key}={value}")]
    start = time.monotonic()
    run(bench.build / "voxweld", "run", config, *sets)
    return bench.folder / "run.mesh", time.monotonic() - start


def voxweld_lines(bench, volume):
    voxweld = bench.build / "voxweld"
    for name, variant in VARIANTS.items():
        unknown = [key for key, value in variant.needed.items() if not knows(voxweld, key, value)]
        if unknown:
            print(f"voxweld {name}: skipped, this voxweld does not know {', '.join(unknown)}")
            continue
        also = {key: value for key, value in variant.if_known.items() if knows(voxweld, key, value)}
        for tolerance in TOLERANCES:
            settings = {"simplify.tolerance": tolerance, **variant.needed, **also}
            bench.note(
                volume,
                f"voxweld {name}",
                tolerance,
                lambda s=settings: run_voxweld(bench, volume, s),
            )


def openvdb_line(bench, volume):
    target = bench.folder / "peer.ply"
    for adaptivity in ADAPTIVITIES:
        bench.note(
            volume,
            "OpenVDB",
            adaptivity,
            lambda a=adaptivity: (target, float(peer("openvdb", bench.volume(volume), target, a))),
        )


def simplified_lines(bench, volume, programs):
    """Of FlyingEdges' mesh, and that itself."""
    bench.note(volume, "FlyingEdges", 1, lambda: bench.flying_edges(volume))
    target = bench.folder / "peer.ply"

    def simplified(simplify, share):
        full, seconds = bench.flying_edges(volume)
        return target, seconds + float(simplify(full, target, share))

    for name, simplify in programs.items():
        for share in SHARES:
            bench.note(volume, name, share, lambda s=simplify, k=share: simplified(s, k))


def installed_peers(build):
    """What can be asked, and how; what cannot is said."""
    with_vtk = has_peer("flying_edges")
    meshopt = build / "meshopt_simplify"
    simplifiers = {
        "meshoptimizer": (meshopt.exists(), lambda *a: run(meshopt, *a)),
        "VTK quadric": (True, lambda *a: peer("vtk_quadric", *a)),
    }
    found = {"OpenVDB": has_peer("openvdb"), "FlyingEdges": with_vtk}
    found.update({name: there and with_vtk for name, (there, _) in simplifiers.items()})
    for name, there in found.items():
        if not there:
            print(f"{name}: skipped, not installed")
    return found, {name: use for name, (_, use) in simplifiers.items() if found[name]}


def measure_all(arguments, folder):
    bench = Bench(arguments, folder)
    found, simplifiers = installed_peers(bench.build)
    for volume in arguments.only or VOLUMES:
        if volume == "bunny" and not (bench.bunny and bench.bunny.exists()):
            print("bunny: skipped, its scan is not there (--bunny)")
            continue
        if volume in BY_REFERENCE and not found["FlyingEdges"]:
            print(f"{volume}: skipped, FlyingEdges makes the mesh that all are measured by")
            continue
        voxweld_lines(bench, volume)
        if found["OpenVDB"]:
            openvdb_line(bench, volume)
        if found["FlyingEdges"]:
            simplified_lines(bench, volume, simplifiers)
        if not arguments.work:  # the large files of one volume at a time
            for path in folder.glob(f"{volume}-*"):
                path.unlink()


def parsed():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument(
        "--build",
        type=pathlib.Path,
        default=HERE.parent.parent / "build",
        help="folder with voxweld, measure_output and meshopt_simplify (build)",
    )
    parser.add_argument("--size", type=int, default=512, help="samples a side (512)")
    parser.add_argument(
        "--only", action="append", choices=VOLUMES, help="this volume; may be given again"
    )
    parser.add_argument(
        "--skip",
        action="append",
        default=[],
        metavar="PROGRAM",
        help='as the picture names it, such as "VTK quadric"; may be given again',
    )
    parser.add_argument(
        "--again",
        action="append",
        default=[],
        metavar="PROGRAM",
        help="forgets its figures first, for it has changed",
    )
    parser.add_argument(
        "--bunny",
        type=pathlib.Path,
        help="the Stanford bunny's CT: 512 x 512 x 361 big-endian int16, .xz",
    )
    parser.add_argument(
        "--work",
        type=pathlib.Path,
        help="where volumes and meshes lie, to keep them (a folder that is deleted)",
    )
    parser.add_argument(
        "-o",
        "--output",
        type=pathlib.Path,
        default=pathlib.Path("pareto.json"),
        help="the figures (pareto.json)",
    )
    parser.add_argument(
        "--picture", type=pathlib.Path, help="the picture (pareto.png beside the figures)"
    )
    parser.add_argument(
        "--draw", action="store_true", help="only draws the picture, from the figures"
    )
    return parser.parse_args()


def main():
    arguments = parsed()
    if arguments.draw and not arguments.output.exists():
        sys.exit(f"pareto.py: {arguments.output}: no such file; run without --draw first")
    if not arguments.draw:
        if arguments.work:
            arguments.work.mkdir(parents=True, exist_ok=True)
            measure_all(arguments, arguments.work.resolve())
        else:
            with tempfile.TemporaryDirectory() as folder:
                measure_all(arguments, pathlib.Path(folder))
    try:
        import pareto_picture
    except ImportError as missing:
        print(f"no picture: {missing}")
        return
    picture = arguments.picture or arguments.output.with_suffix(".png")
    records = (
        json.loads(arguments.output.read_text())["records"] if arguments.output.exists() else []
    )
    pareto_picture.draw([r for r in records if r["size"] == arguments.size], VOLUMES, picture)


if __name__ == "__main__":
    main()
