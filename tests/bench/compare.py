"""Two builds of voxweld, by turns: ratios of processor seconds, new to old, with their spread.

Runs the kernels (bench_kernels) where both builds have them, and voxweld itself on phantoms. Each
turn runs both builds, so that what else the machine does hits both alike. A ratio below 1 means
that the new build is faster; it is clearly so where its slowest turn was faster than the old one's
fastest, of five turns or more. The ratio of their quickest turns suffers least from others' work.
"""
import argparse
import json
import pathlib
import statistics
import sys

import programs
import tables
from phantom_measures import PHANTOMS, run


def parsed():
    parser = argparse.ArgumentParser(
        prog="compare.sh", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("old", type=pathlib.Path, metavar="OLD_BUILD", help="a build folder")
    parser.add_argument("new", type=pathlib.Path, metavar="NEW_BUILD", help="another")
    parser.add_argument("--times", type=programs.at_least(1), default=5, help="turns (5)")
    parser.add_argument("--filter", default=".", metavar="REGEX",
                        help="only kernels whose names match")
    parser.add_argument("--min-time", type=float, default=0.2, metavar="SECONDS",
                        help="that each kernel runs in a turn (0.2)")
    parser.add_argument("--runs", type=programs.chosen("volume", [*PHANTOMS, "none"]),
                        default=["gyroid", "part"], metavar="NAMES",
                        help="volumes of whole runs (gyroid,part); none: kernels alone")
    parser.add_argument("--size", type=programs.at_least(16), default=256,
                        help="samples a side of these (256)")
    parser.add_argument("--threads", type=programs.at_least(0), default=0,
                        help="of a run (all cores)")
    return parser.parse_args()


def kernel_seconds(tools, arguments):
    """Name -> seconds of processor an iteration."""
    out = run(tools.bench_kernels, "--benchmark_format=json",
              f"--benchmark_filter={arguments.filter}",
              f"--benchmark_min_time={arguments.min_time}")
    units = {"ns": 1e-9, "us": 1e-6, "ms": 1e-3, "s": 1}
    return {
        one["name"]: one["cpu_time"] * units[one["time_unit"]]
        for one in json.loads(out)["benchmarks"]
    }


def run_seconds(tools, folder, arguments):
    taken = {}
    for kind in arguments.runs:
        volume = tools.phantom(kind, arguments.size, folder)
        _, figures = programs.run_voxweld(tools, volume, folder, "compare", {}, arguments.threads)
        taken[f"voxweld run, {kind} {arguments.size}"] = figures["cpu_s"]
    return taken


def both(builds, measure, times):
    """Name -> (seconds of old, of new) of each turn. What only one of them knows is left out."""
    pairs = {}
    for turn in range(times):
        first = turn % 2  # so that neither gains by its place
        taken = {first: measure(builds[first])}
        taken[1 - first] = measure(builds[1 - first])
        old, new = taken[0], taken[1]
        for name in [name for name in old if name in new]:
            pairs.setdefault(name, []).append((old[name], new[name]))
        print(f"turn {turn + 1} of {times}", file=sys.stderr, flush=True)
    return pairs


def verdict(turns):
    """Only where the two do not overlap: of one build with itself, with five turns, that happens to
    one line in 126 by chance."""
    old, new = zip(*turns)
    if len(turns) < 5:
        return ""
    if max(new) < min(old):
        return "faster"
    return "slower" if min(new) > max(old) else ""


def table(pairs):
    rows = []
    for name, turns in pairs.items():
        if min(old for old, _ in turns) <= 0:
            continue
        ratios = [new / old for old, new in turns]
        rows.append([
            name,
            tables.readable(statistics.median(old for old, _ in turns)),
            tables.readable(statistics.median(new for _, new in turns)),
            f"{statistics.median(ratios):.3f}",
            f"{min(new for _, new in turns) / min(old for old, _ in turns):.3f}",
            f"{min(ratios):.3f} .. {max(ratios):.3f}",
            verdict(turns),
        ])
    heads = ["what", ">old", ">new", ">new / old", ">of the quickest", ">least .. most", "clearly"]
    return tables.markdown(heads, rows)


def compare(arguments, folder):
    builds = [programs.Tools(build, ["voxweld", "timed_run"])
              for build in (arguments.old, arguments.new)]
    pairs = {}
    if all((tools.build / "bench_kernels").exists() for tools in builds):
        pairs.update(both(builds, lambda tools: kernel_seconds(tools, arguments), arguments.times))
    else:
        print("kernels: skipped: not both builds have bench_kernels (libbenchmark-dev)")
    if arguments.runs != ["none"]:
        pairs.update(both(builds, lambda tools: run_seconds(tools, folder, arguments),
                          arguments.times))
    machine = programs.Machine()
    print(f"{arguments.times} turns, seconds of processor; {machine.known['cores']} cores of "
          f"{machine.known['model']}.\n\n{table(pairs)}")


def main():
    arguments = parsed()
    return programs.in_folder("compare.sh", "compare", None,
                              lambda folder: compare(arguments, folder))


if __name__ == "__main__":
    sys.exit(main())
