"""voxweld on labels beside VTK, which makes a mesh of each label by itself. See README.md beside it.

Each program runs in turn; the table has the medians. The volume is an NRRD file, raw, little-endian,
of uint8, uint16 or uint32, 0 around the labels; without one the phantom `labels` is made.
"""
import argparse
import json
import math
import pathlib
import sys

import programs
import tables
from phantom_measures import Failed, run

HERE = pathlib.Path(__file__).resolve().parent
SETTINGS = {"simplify.refine": "off", "output.merged": False, "output.report": False,
            "output.formats": '["drc"]'}
VARIANTS = {
    "voxweld, each label": {"labels.mode": "each"},
    "voxweld, each label, tolerance 0.2": {"labels.mode": "each", "simplify.tolerance": 0.2},
    "voxweld, shared": {"labels.mode": "shared"},
}
PEER = "FlyingEdges, each label"


def parsed():
    parser = argparse.ArgumentParser(
        prog="labels.sh", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("-o", "--output", type=pathlib.Path, metavar="FOLDER",
                        help="where meshes and labels.json stay (a folder that is deleted)")
    parser.add_argument("--volume", type=pathlib.Path, metavar="FILE",
                        help="the labels (the phantom, of --size)")
    parser.add_argument("--size", type=programs.at_least(16), default=256,
                        help="samples a side of the phantom (256)")
    parser.add_argument("--times", type=programs.at_least(1), default=3, help="turns (3)")
    parser.add_argument("--threads", type=programs.at_least(0), default=0,
                        help="of each program (all cores)")
    parser.add_argument("--build", type=pathlib.Path, default=HERE.parent.parent / "build",
                        help="folder that voxweld was built in (build)")
    return parser.parse_args()


def samples_of(volume):
    """As the header says."""
    with open(volume, "rb") as file:
        for line in file:
            if line.startswith(b"sizes:"):
                return math.prod(int(word) for word in line.split()[1:])
    raise Failed(f"{volume}: its header has no sizes")


def run_voxweld(tools, volume, folder, name, threads):
    config = folder / f"{programs.slug(name)}.toml"
    config.write_text(f'[input]\npath = "{volume}"\n')
    mesh, work = (config.with_suffix(f".{kind}") for kind in ("mesh", "work"))
    programs.remove(mesh)
    programs.remove(work)
    settings = {**SETTINGS, "run.threads": threads, **VARIANTS[name]}
    figures, printed = tools.timed(folder, programs.run_command(tools, config, settings))
    figures["triangles"] = json.loads(printed)["counts"]["triangles"]
    figures["output_bytes"] = sum(p.stat().st_size for p in mesh.rglob("*") if p.is_file())
    return figures


def run_peer(tools, volume, folder, threads):
    mesh = folder / "peer_labels"
    programs.remove(mesh)
    command = [tools.build / "bench_peers" / "peer_labels", volume, mesh, threads]
    figures, printed = tools.timed(folder, command)
    figures["triangles"] = json.loads(printed)["triangles"]
    figures["output_bytes"] = sum(p.stat().st_size for p in mesh.iterdir())
    return figures


def table(results, samples):
    rows = []
    for name, turns in results.items():
        middle = tables.medians(turns)
        rows.append([
            name,
            tables.seconds(middle["wall_s"]),
            tables.seconds(middle["cpu_s"]),
            f"{samples / 1e6 / middle['wall_s']:.1f}",
            f"{middle['peak_bytes'] / 1e6:.0f}",
            f"{middle['triangles']:,.0f}",
            f"{middle['output_bytes'] / 1e6:.1f}",
        ])
    heads = ["program", ">wall, s", ">CPU, s", ">million samples a second", ">peak, MB",
             ">triangles", ">mesh, MB"]
    return tables.markdown(heads, rows)


def bench(arguments, folder):
    tools = programs.Tools(arguments.build, ["voxweld", "timed_run"])
    programs.build_peers(tools.build)
    volume = arguments.volume
    if volume is None:
        volume = folder / f"labels-{arguments.size}.nrrd"
        if not volume.exists():
            run(tools.voxweld, "phantom", "labels", "--size", arguments.size, "-o", volume)
    volume = volume.resolve()
    names = list(VARIANTS)
    if (tools.build / "bench_peers" / "peer_labels").exists():
        names.append(PEER)
    results = {name: [] for name in names}
    machine = programs.Machine()
    for turn in range(arguments.times):
        for name in names:
            if name == PEER:
                figures = run_peer(tools, volume, folder, arguments.threads)
            else:
                figures = run_voxweld(tools, volume, folder, name, arguments.threads)
            results[name].append(figures)
            print(f"{name}, turn {turn + 1}: {figures['wall_s']:.2f} s, "
                  f"{figures['peak_bytes'] / 1e6:.0f} MB", flush=True)
    samples = samples_of(volume)
    found = {"machine": machine.describe(), "samples": samples, "programs": results}
    programs.write_json(folder / "labels.json", found)
    print(f"\n{samples:,} samples: medians of {arguments.times} turns; "
          f"{programs.machine_line(found['machine'])}.\n")
    print(table(results, samples))
    return 0


if __name__ == "__main__":
    given = parsed()
    sys.exit(programs.in_folder("labels.sh", "labels", given.output, lambda f: bench(given, f)))
