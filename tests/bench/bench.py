"""voxweld beside what its users would otherwise take. See README.md beside it.

Builds the peers that can be built, makes phantoms, runs all programs in turn, measures each mesh
once, and prints a table of medians. A peer whose packages are missing is left out by name. What
bench.json in FOLDER has of other volumes comes into the table as well.
"""
import argparse
import json
import pathlib
import sys

import programs
import tables
from phantom_measures import BY_REFERENCE, PHANTOMS, Failed, fine_mesh, has_peer, measure

HERE = pathlib.Path(__file__).resolve().parent
NEEDED = ["voxweld", "measure_output", "bare_pass", "timed_run"]


def parsed():
    parser = argparse.ArgumentParser(
        prog="run.sh", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("-o", "--output", type=pathlib.Path, metavar="FOLDER", default=None,
                        help="where volumes, meshes and bench.json stay (a folder that is deleted)")
    parser.add_argument("--only", type=programs.chosen("volume", PHANTOMS), default=PHANTOMS,
                        metavar="NAMES", help=f"volumes, as in {','.join(PHANTOMS)} (all)")
    parser.add_argument("--programs", metavar="TEXT",
                        help="only those whose name in the table has TEXT in it, and voxweld")
    parser.add_argument("--size", type=programs.at_least(16), default=512,
                        help="samples a side (512)")
    parser.add_argument("--times", type=programs.at_least(1), default=5, help="turns (5)")
    parser.add_argument("--threads", type=programs.at_least(0), default=0,
                        help="of each program (all cores)")
    parser.add_argument("--build", type=pathlib.Path, default=HERE.parent.parent / "build",
                        help="folder that voxweld and its tests were built in (build)")
    parser.add_argument("--json", type=pathlib.Path, metavar="FILE",
                        help="writes the figures there (FOLDER/bench.json)")
    parser.add_argument("--no-distances", action="store_true",
                        help="does not measure the meshes, which takes longer than making them: "
                        "what bench.json has of those with as many triangles stays")
    parser.add_argument("--print", action="store_true",
                        help="runs nothing: prints the table of what bench.json in FOLDER has")
    parser.add_argument("--table", action="store_true",
                        help="also writes the table into README.md beside this script")
    return parser.parse_args()


class Bench:
    def __init__(self, arguments, folder, earlier):
        self.arguments, self.folder, self.earlier = arguments, folder, earlier
        self.tools = programs.Tools(arguments.build, NEEDED)
        wanted = arguments.programs or ""
        self.variants = {
            name: settings
            for name, settings in programs.VARIANTS.items()
            if wanted in name or name == programs.MAIN
        }
        self.peers = [name for name in programs.build_peers(self.tools.build) if wanted in name]
        self.failed = []

    def one(self, volume, name):
        """The mesh and the figures of one process."""
        threads = self.arguments.threads
        if name in self.variants:
            return programs.run_voxweld(
                self.tools, volume, self.folder, name, self.variants[name], threads
            )
        return programs.run_peer(self.tools, volume, self.folder, name, threads)

    def turns(self, volume, kind):
        """All programs, one after the other, as often as asked: name -> [mesh, figures]."""
        made = {}
        for turn in range(self.arguments.times):
            for name in [*self.variants, *self.peers]:
                try:
                    mesh, figures = self.one(volume, name)
                except Failed as problem:
                    self.failed.append(f"{kind}, {name}: {problem}")
                    print(f"{self.failed[-1]}", flush=True)
                    continue
                made.setdefault(name, [mesh, []])[1].append(figures)
                print(
                    f"{kind} {self.arguments.size}, turn {turn + 1}, {name}: "
                    f"{figures['wall_s']:.2f} s, {figures['cpu_s']:.2f} s of processor, "
                    f"{figures['peak_bytes'] / 1e6:.0f} MB",
                    flush=True,
                )
        return made

    def measured_earlier(self, kind, name, triangles):
        """What is known of a mesh of that size."""
        volume = self.earlier.get(kind, {})
        mesh = volume.get("programs", {}).get(name, {}).get("mesh")
        same = volume.get("size") == self.arguments.size and mesh
        return mesh if same and mesh["triangles"] == triangles else None

    def measured(self, volume, kind, mesh):
        fine = None
        if kind in BY_REFERENCE:
            if not has_peer("fine"):
                print(f"{kind}: no distances: python3-vtk9, which makes the fine mesh, is missing")
                return None
            fine = fine_mesh(volume, volume.with_suffix(".fine.ply"))
        return measure(self.tools.measure_output, mesh, kind, self.arguments.size, fine)

    def same_mesh(self, name):
        """Equal for programs that make the same mesh: memory and kinds of files change nothing."""
        settings = self.variants.get(name)
        if settings is None:
            return name
        return str([pair for pair in settings.items() if pair[0].startswith("simplify.")])

    def volume(self, kind):
        volume = self.tools.phantom(kind, self.arguments.size, self.folder)
        bare = programs.bare_pass(self.tools, volume, self.arguments.threads)  # fills the cache too
        print(f"{kind}: {bare['active_cells']:,} active cells, bare pass {bare['bare_pass_ms']} ms",
              flush=True)
        machine = programs.Machine()
        made = self.turns(volume, kind)
        found = {"size": self.arguments.size, "times": self.arguments.times,
                 "machine": machine.describe(), **bare}
        return {**found, "programs": self.with_meshes(volume, kind, made)}

    def with_meshes(self, volume, kind, made):
        """Figures of each program, and those of its mesh, which goes."""
        results, known = {}, {}
        for name, (mesh, turns) in made.items():
            results[name] = {"medians": tables.medians(turns), "turns": turns}
            same = self.same_mesh(name)
            try:
                if self.arguments.no_distances:
                    known[same] = self.measured_earlier(kind, name, turns[0]["triangles"])
                if same not in known:
                    known[same] = self.measured(volume, kind, mesh)
            except Failed as problem:
                self.failed.append(f"{kind}, {name}: {problem}")
                print(self.failed[-1], flush=True)
            if known.get(same) is not None:
                results[name]["mesh"] = known[same]
            programs.remove(mesh)
            programs.remove(mesh.with_suffix(".work"))
        return results


def earlier(target):
    """What the file has of other volumes stays, so that one can be measured again."""
    return json.loads(target.read_text()) if target.exists() else {"volumes": {}}


def heading(volumes):
    return "\n".join(
        f"- {kind}, {volume['size']}^3 samples, uint16: medians of {volume['times']} turns; bare "
        f"pass {volume['bare_pass_ms']:.1f} ms for {volume['active_cells']:,} active cells; "
        f"{programs.machine_line(volume['machine'])}."
        for kind, volume in volumes.items()
    )


def bench(arguments, folder):
    target = arguments.json or folder / "bench.json"
    results = earlier(target)
    if arguments.print:
        if not results["volumes"]:
            sys.exit(f"run.sh: {target}: no figures to print; make some without --print")
        return show(arguments, results)
    work = Bench(arguments, folder, dict(results["volumes"]))
    for kind in arguments.only:
        results["volumes"][kind] = work.volume(kind)
        programs.write_json(target, results)
    show(arguments, results)
    return 1 if work.failed else 0


def show(arguments, results):
    text = heading(results["volumes"]) + "\n\n" + tables.results_table(results)
    print("\n" + text)
    if arguments.table:
        tables.replace_between(HERE / "README.md", "table of run.sh", text)
    return 0


def main():
    arguments = parsed()
    return programs.in_folder("run.sh", "bench", arguments.output,
                              lambda folder: bench(arguments, folder))


if __name__ == "__main__":
    sys.exit(main())
