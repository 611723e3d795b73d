#!/usr/bin/env python3
"""Opens the merged mesh of an output, in each of its formats, with programs that people use.

Usage: mesh_files.py OUTPUT_FOLDER

The programs are VTK, Assimp, ADMesh, MeshLab and Blender; one that is missing is skipped by name. Each has to find
as many triangles as the manifest says, and the same volume and area, in cubic and square millimetres. Exits 1
where one does not, 77 where none of them is there.
"""
import json
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

try:
    import numpy as np
except ImportError as missing:
    print(f"skipped: {missing}")
    sys.exit(77)

HERE = pathlib.Path(__file__).resolve().parent
MESHLAB_SCRIPT = '<!DOCTYPE FilterScript><FilterScript><filter name="Compute Geometric Measures"/></FilterScript>'


def measured(points, triangles):
    a, b, c = (points[triangles[:, k]].astype(float) for k in range(3))
    cross = np.cross(b - a, c - a)
    return {"triangles": len(triangles), "volume": float(np.einsum("ij,ij->", a - points.mean(axis=0), cross) / 6),
            "area": float(np.linalg.norm(cross, axis=1).sum() / 2)}


def vtk(path):
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkFiltersCore import vtkTriangleFilter
    from vtkmodules.vtkFiltersGeometry import vtkCompositeDataGeometryFilter
    from vtkmodules.vtkIOGeometry import vtkGLTFReader, vtkOBJReader, vtkSTLReader
    from vtkmodules.vtkIOPLY import vtkPLYReader
    from vtkmodules.vtkIOXML import vtkXMLPolyDataReader, vtkXMLPPolyDataReader
    reader = {"ply": vtkPLYReader, "stl": vtkSTLReader, "obj": vtkOBJReader, "vtp": vtkXMLPolyDataReader, "pvtp": vtkXMLPPolyDataReader,
              "glb": vtkGLTFReader}[path.suffix[1:]]()
    reader.SetFileName(str(path))
    last = reader
    if path.suffix == ".glb":
        last = vtkCompositeDataGeometryFilter()
        last.SetInputConnection(reader.GetOutputPort())
    triangles = vtkTriangleFilter()
    triangles.SetInputConnection(last.GetOutputPort())
    triangles.Update()
    data = triangles.GetOutput()
    if data.GetNumberOfPolys() == 0:
        return {"error": "no triangles"}
    corners = vtk_to_numpy(data.GetPolys().GetConnectivityArray()).reshape(-1, 3)
    return measured(vtk_to_numpy(data.GetPoints().GetData()), corners)


def read_stl(path):
    kinds = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("rest", "<u2")])
    corners = np.fromfile(path, dtype=kinds, offset=84)["corners"].reshape(-1, 3)
    return measured(corners, np.arange(len(corners)).reshape(-1, 3))


def called(*command):
    return subprocess.run([str(part) for part in command], capture_output=True, text=True, timeout=600, check=False)


def assimp(path):
    with tempfile.TemporaryDirectory() as folder:
        written = pathlib.Path(folder) / "written.stl"
        done = called("assimp", "export", path, written, "-fstlb")
        if not written.exists():
            said = [line for line in (done.stdout + done.stderr).splitlines() if "rror" in line or "nable" in line]
            return {"error": said[-1].strip() if said else f"exit status {done.returncode}"}
        return read_stl(written)


def admesh(path):
    said = called("admesh", path).stdout
    number = lambda pattern: float(re.search(pattern, said).group(1))
    # Facets that have no neighbour at an edge: ADMesh's own view of whether it is closed.
    open_facets = number(r"Total disconnected facets\s*:\s*(\d+)")
    found = {"triangles": int(number(r"Number of facets\s*:\s*\d+\s+(\d+)") if re.search(r"Number of facets\s*:\s*\d+\s+(\d+)", said)
                              else number(r"Number of facets\s*:\s*(\d+)")), "volume": number(r"Volume\s*:\s*(-?[\d.]+)")}
    return found if open_facets == 0 else {"error": f"{open_facets:.0f} facets are not connected"}


def meshlab(path):
    with tempfile.NamedTemporaryFile("w", suffix=".mlx") as script:
        script.write(MESHLAB_SCRIPT)
        script.flush()
        done = called("xvfb-run", "-a", "meshlabserver", "-i", path, "-s", script.name)
    said = done.stdout + done.stderr
    faces, volume = re.search(r"has \d+ vn (\d+) fn", said), re.search(r"Mesh Volume +is (-?[\d.]+)", said)
    area = re.search(r"Mesh Surface Area is (-?[\d.]+)", said)
    if not faces or not volume:
        return {"error": said.strip().splitlines()[-1]}
    return {"triangles": int(faces.group(1)), "volume": float(volume.group(1)), "area": float(area.group(1))}


def reads_any_obj(open_with):
    """Whether it opens a tetrahedron written by hand."""
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / "mesh.obj"
        path.write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n", encoding="ascii")
        return "error" not in open_with(path)


def blender(path):
    said = called("blender", "-b", "--factory-startup", "--python", HERE / "mesh_files_blender.py", "--", path).stdout
    lines = [line[6:] for line in said.splitlines() if line.startswith("FOUND ")]
    return json.loads(lines[0]) if lines else {"error": said.strip().splitlines()[-1]}


def has_vtk():
    try:
        import vtkmodules.vtkIOGeometry  # noqa: F401
    except ImportError:
        return False
    return True


# What each is known to read, by the ending; others are not given to it.
PROGRAMS = {
    "VTK": (vtk, has_vtk, ["ply", "stl", "obj", "vtp", "pvtp", "plain.glb"]),
    "Assimp": (assimp, lambda: shutil.which("assimp"), ["ply", "stl", "obj", "plain.glb"]),
    "ADMesh": (admesh, lambda: shutil.which("admesh"), ["stl"]),
    "MeshLab": (meshlab, lambda: shutil.which("meshlabserver") and shutil.which("xvfb-run"), ["ply", "stl", "obj"]),
    "Blender": (blender, lambda: shutil.which("blender"), ["ply", "stl", "obj", "plain.glb"]),
}
ENDINGS = ["ply", "stl", "obj", "vtp", "pvtp", "plain.glb"]


def main():
    folder = pathlib.Path(sys.argv[1])
    manifest = json.loads((folder / "manifest.json").read_text())
    wanted = manifest["counts"]["triangles"]
    unit = {"mm": 1e-3}[manifest["frame"]["unit"]]
    rows, wrong, reference, there = [], [], None, 0
    for name, (open_with, is_there, endings) in PROGRAMS.items():
        if not is_there():
            print(f"skipped: {name}")
            continue
        there += 1
        for ending in endings:
            try:
                found = open_with(folder / ("tiles.pvtp" if ending == "pvtp" else f"mesh.{ending}"))
            except Exception as error:  # whatever the output of a program broke
                found = {"error": f"{type(error).__name__}: {error}"}
            if "error" in found and ending == "obj" and not reads_any_obj(open_with):
                print(f"skipped: {name} {ending}: it does not open a tetrahedron written by hand either ({found['error']})")
                continue
            if "error" in found:
                wrong.append(f"{name} {ending}: {found['error']}")
                rows.append((name, ending, "", "", ""))
                continue
            scale = 1 / unit if ending.endswith("glb") else 1  # glTF is in metres
            volume, area = found["volume"] * scale**3, found.get("area", float("nan")) * scale**2
            reference = reference or (volume, area)
            rows.append((name, ending, f"{found['triangles']:,}", f"{volume:.4f}", "" if area != area else f"{area:.3f}"))
            if found["triangles"] != wanted:
                wrong.append(f"{name} {ending}: {found['triangles']} triangles, the manifest says {wanted}")
            if abs(volume / reference[0] - 1) > 1e-4 or abs(area / reference[1] - 1) > 1e-4:
                wrong.append(f"{name} {ending}: volume {volume}, area {area}; VTK has {reference}")
    print("| program | file | triangles | volume, mm^3 | area, mm^2 |\n| --- | --- | ---: | ---: | ---: |")
    for row in rows:
        print("| " + " | ".join(row) + " |")
    for text in wrong:
        print(f"FAILED files: {text}")
    if there == 0:
        return 77
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
