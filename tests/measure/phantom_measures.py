"""What scripts share that measure meshes of phantoms and scans with measure_output."""
import json
import pathlib
import subprocess
import sys

PEERS = pathlib.Path(__file__).resolve().parent / "pareto_peers.py"
PHANTOMS = ["part", "gyroid", "porous"]
# Of these the true surface is not known. A mesh of their middle, of twice as many samples made by
# cubic interpolation, stands for it: no program measured here makes that one.
BY_REFERENCE = ["porous", "bunny"]
MIDDLE = 256
# Their outermost samples are empty: that step says only between which samples the surface is.
INSET = 3


class Failed(Exception):
    pass


def run(*command):
    result = subprocess.run([str(part) for part in command], capture_output=True, text=True)
    if result.returncode != 0:
        lines = result.stderr.strip().splitlines() or [f"exit code {result.returncode}"]
        raise Failed(f"{pathlib.Path(command[0]).name}: {lines[-1]}")
    return result.stdout


def peer(*arguments):
    return run(sys.executable, PEERS, *arguments)


def has_peer(program):
    probe = subprocess.run([sys.executable, PEERS, "probe", program], capture_output=True)
    return probe.returncode == 0


def surface_of(volume):
    """isovalue and inside, from the volume's comment."""
    with open(volume, "rb") as file:
        for line in file:
            words = line.decode(errors="replace").replace(",", "").split()
            if words[:2] == ["#", "isovalue"]:
                return words[2], words[4]
    raise Failed(f"{volume}: says no isovalue")


def fine_mesh(volume, target):
    """The mesh that stands for the surface of one of BY_REFERENCE; made once."""
    if not target.exists():
        part = target.with_name("part.ply")
        peer("fine", volume, part, MIDDLE)
        part.replace(target)
    return target


def measure(measure_output, mesh, kind, size, fine=None):
    """All that measure_output says of a mesh. fine: of one of BY_REFERENCE, its fine mesh."""
    true = [kind, size] if fine is None else ["--reference", fine, "--inset", INSET]
    return json.loads(run(measure_output, mesh, *true, "--json"))
