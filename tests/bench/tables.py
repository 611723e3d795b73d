"""Medians, tables in Markdown, and where they stand in README.md."""
import statistics

from programs import MAIN


def medians(turns):
    """Of each figure that all turns have as a number."""
    return {
        key: statistics.median(turn[key] for turn in turns)
        for key, value in turns[0].items()
        if isinstance(value, (int, float))
    }


def markdown(heads, rows):
    """heads: names; those that begin with > are of numbers, to the right."""
    lines = [heads, ["---:" if head.startswith(">") else "---" for head in heads], *rows]
    lines[0] = [head.lstrip(">") for head in heads]
    return "\n".join("| " + " | ".join(str(cell) for cell in line) + " |" for line in lines)


HEADS = [
    "volume",
    "program",
    ">wall, s",
    ">of voxweld's",
    ">least wall, s",
    ">CPU, s",
    ">of voxweld's",
    ">peak, MB",
    ">of voxweld's",
    ">meshing, s",
    ">read, MB",
    ">mesh, MB",
    ">triangles",
    ">mean",
    ">99 % within",
    ">intersecting pairs",
    ">bad edges",
]


def seconds(value):
    return f"{value:.2f}" if value < 10 else f"{value:.1f}"


def readable(seconds):
    for unit, size in (("s", 1), ("ms", 1e-3), ("us", 1e-6)):
        if seconds >= size:
            return f"{seconds / size:.3g} {unit}"
    return f"{seconds * 1e9:.3g} ns"


def row(name, result, main):
    middle, mesh = result["medians"], result.get("mesh")
    cells = [name]
    for key, text in (
        ("wall_s", seconds),
        ("cpu_s", seconds),
        ("peak_bytes", lambda value: f"{value / 1e6:.0f}"),
    ):
        ratio = f"{middle[key] / main[key]:.2f}" if main and main[key] > 0 else ""
        cells += [text(middle[key]), ratio]
        if key == "wall_s":
            cells.append(text(min(turn[key] for turn in result["turns"])))
    cells += [
        seconds(middle["meshing_s"]) if "meshing_s" in middle else "",
        f"{middle['read_bytes'] / 1e6:,.0f}",
        f"{middle['output_bytes'] / 1e6:.1f}",
        f"{middle['triangles']:,.0f}",
    ]
    if mesh is None:
        return [*cells, "", "", "", ""]
    far, defects = mesh["mesh_to_surface_by_area"], mesh["defects"]
    return [
        *cells,
        f"{far['mean']:.4f}",
        f"{far['p99']:.3f}",
        f"{defects['intersecting_pairs']:,}",
        f"{defects['nonmanifold_edges'] + defects['boundary_edges']:,}",
    ]


def results_table(results):
    rows = []
    for kind, volume in results["volumes"].items():
        programs = volume["programs"]
        main = programs.get(MAIN, {}).get("medians")
        for at, (name, result) in enumerate(programs.items()):
            rows.append([kind if at == 0 else "", *row(name, result, main)])
    return markdown(HEADS, rows)


def replace_between(path, name, text):
    """Puts text between the two comments that mark this place in the file."""
    begin, end = f"<!-- {name}: begin -->\n", f"<!-- {name}: end -->"
    whole = path.read_text()
    if begin not in whole or end not in whole:
        raise SystemExit(f"{path}: has no lines {begin.strip()} and {end}, between which to write")
    before, rest = whole.split(begin, 1)
    path.write_text(before + begin + "\n" + text + "\n\n" + end + rest.split(end, 1)[1])
