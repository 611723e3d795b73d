"""What run.sh and scaling.sh run: voxweld with several settings and the peers, each in a process of
its own that timed_run measures."""
import argparse
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
sys.path.append(str(HERE.parent / "measure"))
from phantom_measures import Failed, run, surface_of  # noqa: E402

# The main line: what all others are compared with.
MAIN = "voxweld"
SETTINGS = {
    "simplify.refine": "collapse",
    "simplify.tolerance": 0.1,
    "run.memory": "4GiB",
    "output.merged": False,
    "output.report": False,
}
# What else voxweld is asked for, as it differs from that.
VARIANTS = {
    MAIN: {},
    "voxweld, 256 MiB": {"run.memory": "256MiB"},
    "voxweld, tolerance 0.2": {"simplify.tolerance": 0.2},
    "voxweld, with merged mesh and report": {"output.merged": "auto", "output.report": True},
    "voxweld, repair": {"simplify.refine": "repair"},
    "voxweld, repair, tolerance 0.2": {"simplify.refine": "repair", "simplify.tolerance": 0.2},
    "voxweld, refine off": {"simplify.refine": "off"},
    "voxweld, refine off, 256 MiB": {"simplify.refine": "off", "run.memory": "256MiB"},
}
# Program, its arguments after volume and mesh, and the Debian packages it is built with.
PEERS = {
    "OpenVDB, adaptivity 0.1": ("peer_openvdb", ["0.1"]),
    "FlyingEdges": ("peer_flying_edges", ["0"]),
    "FlyingEdges, meshoptimizer 0.1": ("peer_flying_edges", ["0.1"]),
}


def slug(name):
    return re.sub(r"[^a-z0-9.]+", "-", name.lower()).strip("-")


def remove(path):
    if path.is_dir():
        shutil.rmtree(path)
    else:
        path.unlink(missing_ok=True)


def chosen(what, known):
    """A type for argparse: names of those known, with commas between them."""

    def parse(text):
        names = [name.strip() for name in text.split(",")]
        for name in names:
            if name not in known:
                raise argparse.ArgumentTypeError(
                    f"unknown {what}: {name}; known are: {', '.join(known)}"
                )
        return names

    return parse


def at_least(least):
    """A type for argparse: a whole number, no smaller."""

    def parse(text):
        if not re.fullmatch(r"\d+", text) or int(text) < least:
            raise argparse.ArgumentTypeError(f"{text}: expected a whole number of at least {least}")
        return int(text)

    return parse


def numbers_from(least):
    """The same of several, with commas between them."""
    one = at_least(least)
    return lambda text: [one(word) for word in text.split(",")]


def write_json(path, results):
    part = path.with_name(path.name + ".part")
    part.write_text(json.dumps(results, indent=1) + "\n")
    part.replace(path)


class Tools:
    """The programs of one build folder."""

    def __init__(self, build, needed):
        self.build = build.resolve()
        missing = " ".join(name for name in needed if not (self.build / name).exists())
        if missing:
            sys.exit(
                f"{self.build}: without {missing}; build first: "
                f"cmake -S {HERE.parent.parent} -B {self.build} && "
                f"cmake --build {self.build} --target {missing}"
            )

    def __getattr__(self, name):
        return self.build / name

    def phantom(self, kind, size, folder, sample_type="uint16"):
        path = folder / f"{kind}-{size}.nrrd"
        if not path.exists():
            run(self.voxweld, "phantom", kind, "--size", size, "--type", sample_type, "-o", path)
        return path

    def timed(self, folder, command):
        """Seconds, memory and bytes of one process, and what it printed."""
        figures = folder / "figures.json"
        result = subprocess.run(
            [str(word) for word in (self.timed_run, figures, *command)],
            capture_output=True,
            text=True,
        )
        if result.returncode != 0:
            lines = result.stderr.strip().splitlines() or [f"exit code {result.returncode}"]
            raise Failed(f"{pathlib.Path(command[0]).name}: {lines[-1]}")
        return json.loads(figures.read_text()), result.stdout


def build_peers(build):
    """Builds what is installed into build/bench_peers; gives the names of PEERS that are there."""
    folder = build / "bench_peers"
    generator = ["-G", "Ninja"] if shutil.which("ninja") and not folder.exists() else []
    out = run("cmake", "-S", HERE / "peers", "-B", folder, *generator)
    for line in out.splitlines():
        if "left out:" in line:
            print(line.removeprefix("-- "), flush=True)
    run("cmake", "--build", folder)
    return [name for name, (program, _) in PEERS.items() if (folder / program).exists()]


def run_command(tools, config, settings):
    sets = [
        word
        for key, value in settings.items()
        for word in ("--set", f"{key}={str(value).lower() if isinstance(value, bool) else value}")
    ]
    return [tools.voxweld, "run", config, "--json", "--log-level", "quiet", *sets]


def voxweld_command(tools, volume, folder, name, settings, threads):
    """Writes the config."""
    isovalue, inside = surface_of(volume)
    config = folder / f"{slug(name)}.toml"
    config.write_text(
        f'[input]\npath = "{volume}"\n[surface]\nisovalue = {isovalue}\ninside = "{inside}"\n'
    )
    return run_command(tools, config, {**SETTINGS, "run.threads": threads, **settings})


def run_voxweld(tools, volume, folder, name, settings, threads=0, keep=False):
    """Mesh and figures of one run. keep: what an earlier one left is used, as after a change."""
    stem = folder / slug(name)
    mesh, work = (pathlib.Path(f"{stem}.{kind}") for kind in ("mesh", "work"))
    if not keep:
        remove(mesh)
        remove(work)
    command = voxweld_command(tools, volume, folder, name, settings, threads)
    figures, printed = tools.timed(folder, command)
    manifest = json.loads(printed)
    figures["stages"] = {
        stage["stage"]: {
            "seconds": stage["seconds"],
            "ran": stage["ran"],
            "peak_bytes": stage["peak_resident_bytes"],
        }
        for stage in manifest["stages"]
    }
    figures["output_bytes"] = sum(p.stat().st_size for p in mesh.rglob("*") if p.is_file())
    figures["library"] = manifest["made_by"]["program"]
    figures["triangles"] = manifest["counts"]["triangles"]
    return mesh, figures


def run_peer(tools, volume, folder, name, threads=0):
    program, arguments = PEERS[name]
    mesh = folder / f"{slug(name)}.ply"
    remove(mesh)
    command = [tools.build / "bench_peers" / program, volume, mesh, *arguments, threads]
    figures, printed = tools.timed(folder, command)
    figures.update(json.loads(printed))
    figures["output_bytes"] = mesh.stat().st_size
    return mesh, figures


class Machine:
    """Which one this is, and how busy others keep it while we measure."""

    def __init__(self):
        info = pathlib.Path("/proc/cpuinfo").read_text()
        model = re.search(r"^model name\s*: (.*)$", info, re.M)
        memory = re.search(r"MemTotal:\s*(\d+)", pathlib.Path("/proc/meminfo").read_text())
        self.known = {
            "cores": len(os.sched_getaffinity(0)),
            "model": model[1] if model else "unknown",
            "memory_bytes": 1024 * int(memory[1]),
        }
        self.start = self.now()

    @staticmethod
    def now():
        """Seconds of the clock, of processor by all programs, and by ours."""
        fields = pathlib.Path("/proc/stat").read_text().split("\n", 1)[0].split()[1:]
        ticks = [int(field) for field in fields]
        busy = sum(ticks[:3]) + sum(ticks[5:8])
        ours = os.times()
        hertz = os.sysconf("SC_CLK_TCK")
        return ours.elapsed, busy / hertz, sum(ours[:4])

    def describe(self):
        elapsed, busy, ours = (b - a for a, b in zip(self.start, self.now()))
        others = max(0, busy - ours) / max(elapsed, 1e-9)
        return {**self.known, "cores_taken_by_others": round(others, 2)}


def machine_line(machine):
    return (
        f"{machine['cores']} cores of {machine['model']}, "
        f"{machine['memory_bytes'] / 2**30:.0f} GiB; others took "
        f"{machine['cores_taken_by_others']:.1f} of the cores"
    )


def bare_pass(tools, volume, threads=0):
    """The yardstick of tests/measure: active cells, and milliseconds to count them."""
    isovalue, _ = surface_of(volume)
    used = threads or len(os.sched_getaffinity(0))
    found = re.search(
        r"(\d+) active cells, bare pass ([\d.]+) ms", run(tools.bare_pass, volume, isovalue, used)
    )
    return {"active_cells": int(found[1]), "bare_pass_ms": float(found[2]), "threads": used}


def in_folder(script, name, output, work):
    """What work(folder) returns, the exit status: in the output folder, or else in a temporary one of that name."""
    try:
        if output:
            output.mkdir(parents=True, exist_ok=True)
            return work(output.resolve())
        with tempfile.TemporaryDirectory(prefix=f"voxweld-{name}-") as folder:
            return work(pathlib.Path(folder))
    except Failed as problem:
        print(f"{script}: {problem}", file=sys.stderr)
        return 1
