"""How voxweld's cost grows with the volume, and what a second run saves. See README.md beside it.

Runs voxweld alone: phantoms of several sizes with one thread and two, seconds by stage, peak of
memory, and cost fitted by active cells and bytes of the volume. Then, on what one run left,
runs with one key changed: seconds, and bytes read and written.
"""
import argparse
import itertools
import json
import pathlib
import statistics
import sys

import numpy as np

import programs
import tables
from phantom_measures import PHANTOMS, run, surface_of

HERE = pathlib.Path(__file__).resolve().parent
SAMPLE_BYTES = {"uint8": 1, "uint16": 2, "float32": 4}
# A quarter of a voxel further out, in samples of the phantoms that have this type.
ISOVALUE_STEP = {"uint8": 4, "uint16": 512, "float32": 0.25}


def parsed():
    parser = argparse.ArgumentParser(
        prog="scaling.sh", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--only", type=programs.chosen("volume", PHANTOMS),
                        default=["gyroid", "part"], metavar="NAMES", help="volumes (gyroid,part)")
    parser.add_argument("--sizes", type=programs.numbers_from(16), default=[128, 256, 512],
                        metavar="NUMBERS", help="samples a side (128,256,512)")
    parser.add_argument("--threads", type=programs.numbers_from(1), default=[1, 2],
                        metavar="NUMBERS", help="of a run (1,2)")
    parser.add_argument("--times", type=programs.at_least(1), default=3,
                        help="runs of each, the median counts (3)")
    parser.add_argument("--type", choices=SAMPLE_BYTES, default="uint16",
                        help="of a sample (uint16); uint8 for sizes from 1024 on")
    parser.add_argument("--build", type=pathlib.Path, default=HERE.parent.parent / "build",
                        help="folder that voxweld and its tests were built in (build)")
    parser.add_argument("-o", "--output", type=pathlib.Path, metavar="FOLDER",
                        help="where volumes and scaling.json stay (a folder that is deleted)")
    parser.add_argument("--print", action="store_true",
                        help="runs nothing: prints the tables of scaling.json in FOLDER")
    parser.add_argument("--table", action="store_true",
                        help="also writes the tables into README.md beside this script")
    return parser.parse_args()


def active_cells(tools, folder, name):
    """As the run found them, from what merge left in the work folder."""
    top = next((folder / f"{programs.slug(name)}.work").glob("merge-*/**/top.tree"))
    return json.loads(run(tools.voxweld, "info", top, "--json"))["active_cells"]


def median_run(runs):
    """Each figure's median, those of the stages too."""
    middle = tables.medians(runs)
    middle["stages"] = {
        stage: {
            key: statistics.median(one["stages"][stage][key] for one in runs)
            for key in ("seconds", "peak_bytes")
        }
        for stage in runs[0]["stages"]
    }
    return middle


def grow(tools, folder, arguments):
    """A row for each volume, size and number of threads."""
    rows = []
    for kind in arguments.only:
        for size in arguments.sizes:
            volume = tools.phantom(kind, size, folder, arguments.type)
            volume.read_bytes()  # into the page cache
            for threads in arguments.threads:
                runs = [
                    programs.run_voxweld(tools, volume, folder, "scaling", {}, threads)[1]
                    for _ in range(arguments.times)
                ]
                row = {
                    "volume": kind,
                    "size": size,
                    "threads": threads,
                    "active_cells": active_cells(tools, folder, "scaling"),
                    "volume_bytes": size**3 * SAMPLE_BYTES[arguments.type],
                    **median_run(runs),
                }
                rows.append(row)
                print(f"{kind} {size}, {threads} threads: {row['wall_s']:.2f} s, "
                      f"{row['cpu_s']:.2f} s of processor, {row['peak_bytes'] / 1e6:.0f} MB",
                      flush=True)
    return rows


# What a run's cost may grow with, as rows have it.
TERMS = {
    "active_cells": "an active cell",
    "volume_bytes": "a byte of the volume",
    "triangles": "a triangle of the mesh",
    "runs": "a run",
}


def fitted(rows, key, terms):
    """Seconds of each of the terms, none below 0, by least squares of relative errors; and the
    largest of these."""
    columns = np.array([[row.get(term, 1) / row[key] for term in terms] for row in rows])
    best, least = np.zeros(len(terms)), np.inf
    for chosen in itertools.product([False, True], repeat=len(terms)):
        if not any(chosen):
            continue
        found = np.zeros(len(terms))
        some = list(chosen)
        found[some] = np.linalg.lstsq(columns[:, some], np.ones(len(rows)), rcond=None)[0]
        missed = np.sum((columns @ found - 1) ** 2)
        if found.min() >= 0 and missed < least:
            best, least = found, missed
    return {
        "seconds": dict(zip(terms, best.tolist())),
        "worst_relative_error": float(np.max(np.abs(columns @ best - 1))),
    }


def fits_of(rows):
    """Of seconds of the processor of all runs with one thread, or as few as there are."""
    threads = min(row["threads"] for row in rows)
    some = [row for row in rows if row["threads"] == threads]
    return [
        fitted(some, "cpu_s", terms)
        for terms in (
            ["active_cells", "volume_bytes"],
            ["active_cells", "volume_bytes", "runs"],
            ["active_cells", "volume_bytes", "triangles", "runs"],
        )
    ]


def changes(volume, sample_type):
    """What a second run has different: name -> settings."""
    isovalue = float(surface_of(volume)[0])
    return {
        "nothing": {},
        "tolerance 0.2": {"simplify.tolerance": 0.2},
        "isovalue": {"surface.isovalue": isovalue + ISOVALUE_STEP[sample_type]},
        "formats": {"output.formats": '["ply"]'},
        "tile size": {"output.tile_vertices": 65536},
    }


def second_size(sizes):
    """The largest that takes seconds: each of these runs comes after a first one."""
    return max([size for size in sizes if size <= 512], default=min(sizes))


def second_runs(tools, folder, kind, size, arguments):
    """Each after a run of its own, from whose work it starts."""
    volume = tools.phantom(kind, size, folder, arguments.type)
    rows = []
    for name, settings in changes(volume, arguments.type).items():
        pairs = []
        for _ in range(arguments.times):
            first = programs.run_voxweld(tools, volume, folder, "second", {})[1]
            again = programs.run_voxweld(tools, volume, folder, "second", settings, keep=True)[1]
            pairs.append((first, again))
        ran = [stage for stage, one in pairs[0][1]["stages"].items() if one["ran"] > 0]
        rows.append({
            "volume": kind,
            "size": size,
            "changed": name,
            "ran": ran,
            "first": tables.medians([first for first, _ in pairs]),
            "second": tables.medians([again for _, again in pairs]),
        })
        print(f"{kind} {size}, {name} changed: {rows[-1]['second']['wall_s']:.2f} s after "
              f"{rows[-1]['first']['wall_s']:.2f} s", flush=True)
    return rows


def growth_table(rows):
    stages = list(dict.fromkeys(stage for row in rows for stage in row["stages"]))
    heads = ["volume", ">size", ">threads", ">active cells", ">wall, s", ">CPU, s", ">peak, MB"]
    lines = [
        [
            row["volume"], row["size"], row["threads"], f"{row['active_cells']:,}",
            tables.seconds(row["wall_s"]), tables.seconds(row["cpu_s"]),
            f"{row['peak_bytes'] / 1e6:.0f}",
            *(tables.seconds(row["stages"][s]["seconds"]) if s in row["stages"] else ""
              for s in stages),
        ]
        for row in rows
    ]
    return tables.markdown([*heads, *(f">{stage}" for stage in stages)], lines)


def fit_lines(fits):
    return "\n".join(
        "- "
        + ", ".join(f"{tables.readable(s)} {TERMS[term]}" for term, s in fit["seconds"].items())
        + f"; at worst {100 * fit['worst_relative_error']:.0f} % off"
        for fit in fits
    )


def second_table(rows):
    heads = ["volume", "changed", "stages that ran", ">wall, s", ">of the first", ">CPU, s",
             ">of the first", ">read, MB", ">of the first", ">written, MB"]
    lines = []
    for row in rows:
        first, second = row["first"], row["second"]
        share = {key: f"{second[key] / first[key]:.2f}" for key in ("wall_s", "cpu_s", "read_bytes")
                 if first[key] > 0}
        lines.append([
            f"{row['volume']} {row['size']}", row["changed"], ", ".join(row["ran"]) or "none",
            tables.seconds(second["wall_s"]), share["wall_s"],
            tables.seconds(second["cpu_s"]), share["cpu_s"],
            f"{second['read_bytes'] / 1e6:.1f}", share["read_bytes"],
            f"{second['written_bytes'] / 1e6:.1f}",
        ])
    return tables.markdown(heads, lines)


def scaling(arguments, folder):
    tools = programs.Tools(arguments.build, ["voxweld", "timed_run"])
    machine = programs.Machine()
    rows = grow(tools, folder, arguments)
    seconds = [
        row
        for kind in arguments.only
        for row in second_runs(tools, folder, kind, second_size(arguments.sizes), arguments)
    ]
    return {
        "machine": machine.describe(),
        "type": arguments.type,
        "times": arguments.times,
        "growth": rows,
        "fits": fits_of(rows),
        "second_runs": seconds,
    }


def show(arguments, results):
    text = (
        f"{results['type']}, medians of {results['times']} runs; "
        f"{programs.machine_line(results['machine'])}.\n\n{growth_table(results['growth'])}\n\n"
        "Seconds of the processor, of runs with the fewest threads, fitted:\n\n"
        f"{fit_lines(fits_of(results['growth']))}\n\n"
        f"A second run on what a first one left:\n\n{second_table(results['second_runs'])}"
    )
    print("\n" + text)
    if arguments.table:
        tables.replace_between(HERE / "README.md", "tables of scaling.sh", text)


def work(arguments, folder):
    figures = folder / "scaling.json"
    if arguments.print:
        if not figures.exists():
            sys.exit(f"scaling.sh: {figures}: no such file, so nothing to print")
        return show(arguments, json.loads(figures.read_text()))
    results = scaling(arguments, folder)
    programs.write_json(figures, results)
    return show(arguments, results)


def main():
    arguments = parsed()
    return programs.in_folder("scaling.sh", "scaling", arguments.output,
                              lambda folder: work(arguments, folder))


if __name__ == "__main__":
    sys.exit(main())
