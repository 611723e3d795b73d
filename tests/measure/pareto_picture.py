"""The picture of pareto.py: triangles against distances, a row for each volume."""
import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

PANELS = [
    ("mean", lambda r: r["mesh_to_surface"]["mean"]),
    ("99 % of points are below", lambda r: r["mesh_to_surface"]["p99"]),
    ("99 % of the area is below", lambda r: r["mesh_to_surface_by_area"]["p99"]),
]
# Colours that can be told apart by everyone (Okabe and Ito), and a marker for each program.
STYLES = {
    "voxweld octree": ("#56b4e9", "o"),
    "voxweld refine": ("#0072b2", "D"),
    "OpenVDB": ("#d55e00", "s"),
    "meshoptimizer": ("#009e73", "^"),
    "VTK quadric": ("#cc79a7", "v"),
    "FlyingEdges": ("#000000", "*"),
}
OTHERS = [("#e69f00", "P"), ("#7f7f7f", "X"), ("#8c564b", "p"), ("#bcbd22", "h")]


def short(value, _=None):
    for size, letter in ((1e6, "M"), (1e3, "k")):
        if value >= size:
            return f"{value / size:g}{letter}"
    return f"{value:g}"


def styles_of(programs):
    others = iter(OTHERS * len(programs))
    return {name: STYLES.get(name) or next(others) for name in programs}


def points_of(records, program, value):
    line = sorted(
        (r["triangles"], value(r), r["setting"]) for r in records if r["program"] == program
    )
    return [point for point in line if point[1] > 0]  # 0 has no place on this axis


def draw_panel(axes, records, value, styles):
    for program, (colour, marker) in styles.items():
        if line := points_of(records, program, value):
            axes.plot(
                [p[0] for p in line],
                [p[1] for p in line],
                color=colour,
                marker=marker,
                markersize=6,
                linewidth=1.5,
                label=program,
            )
    axes.set_xscale("log")
    axes.set_yscale("log")
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_locator(LogLocator(base=10, subs=(1, 2, 5)))
        axis.set_major_formatter(FuncFormatter(short))
        axis.set_minor_formatter(NullFormatter())
    axes.grid(True, which="major", color="#dddddd", linewidth=0.8)
    axes.set_axisbelow(True)


def write_settings(axes, records, value, styles):
    """Beside the markers, where none is written yet."""
    taken = []
    for program, (colour, _) in styles.items():
        if program == "FlyingEdges":
            continue
        for triangles, distance, setting in points_of(records, program, value):
            x, y = axes.transData.transform((triangles, distance))
            if any(abs(x - u) < 34 and abs(y - v) < 13 for u, v in taken):
                continue
            taken.append((x, y))
            axes.annotate(
                f"{setting:g}",
                (triangles, distance),
                textcoords="offset points",
                xytext=(6, 3),
                fontsize=8,
                color=colour,
            )


def draw(records, volumes, path):
    rows = [v for v in volumes if any(r["volume"] == v for r in records)]
    if not rows:
        print("no picture: no figures of this size")
        return
    programs = list(dict.fromkeys(r["program"] for r in records))
    order = [name for name in STYLES if name in programs]
    styles = styles_of(order + [name for name in programs if name not in order])
    figure, grid = plt.subplots(
        len(rows),
        len(PANELS),
        figsize=(5.2 * len(PANELS), 4.2 * len(rows) + 0.8),
        squeeze=False,
        dpi=110,
    )
    for volume, line in zip(rows, grid):
        for number, (axes, (title, value)) in enumerate(zip(line, PANELS)):
            own = [r for r in records if r["volume"] == volume]
            draw_panel(axes, own, value, styles)
            axes.set_title(f"{volume}: {title}", fontsize=11)
            axes.set_xlabel("triangles")
            if number == 0:
                axes.set_ylabel("distance to the surface, voxels")
    size = records[0]["size"]
    figure.suptitle(
        f"From the mesh to the surface, {size}³ samples. Towards the lower left is better.\n"
        "Small numbers: tolerance of voxweld, adaptivity of OpenVDB, share of FlyingEdges' "
        "triangles kept by the others",
        fontsize=12,
    )
    handles = {}
    for axes in grid.flat:
        for handle, label in zip(*axes.get_legend_handles_labels()):
            handles.setdefault(label, handle)
    ordered = [name for name in styles if name in handles]
    # Room for the title above and the legend below.
    height = figure.get_figheight()
    figure.tight_layout(rect=(0, 0.45 / height, 1, 1 - 0.3 / height), h_pad=1.5)
    figure.legend(
        [handles[name] for name in ordered],
        ordered,
        loc="lower center",
        ncol=len(ordered),
        frameon=False,
        fontsize=11,
    )
    for volume, line in zip(rows, grid):
        write_settings(line[0], [r for r in records if r["volume"] == volume], PANELS[0][1], styles)
    figure.savefig(path, dpi=figure.dpi)
    print(f"picture: {path}")
