"""Opens mesh files in Blender: blender -b --factory-startup --python mesh_files_blender.py -- FILE ...

Prints a line of JSON for each: triangles, volume and area as Blender has them.
"""
import json
import sys

import bmesh
import bpy
import numpy

# Debian's Blender 3.4 reads glTF with a name that Debian's numpy 1.24 has no longer.
if not hasattr(numpy, "bool"):
    numpy.bool = bool

IMPORTS = {
    "ply": lambda path: bpy.ops.import_mesh.ply(filepath=path),
    "stl": lambda path: bpy.ops.import_mesh.stl(filepath=path),
    "obj": lambda path: bpy.ops.wm.obj_import(filepath=path, forward_axis="Y", up_axis="Z"),
    "glb": lambda path: bpy.ops.import_scene.gltf(filepath=path),
}

for path in sys.argv[sys.argv.index("--") + 1:]:
    bpy.ops.wm.read_factory_settings(use_empty=True)
    found = {"triangles": 0, "volume": 0.0, "area": 0.0}
    try:
        IMPORTS[path.rsplit(".", 1)[1]](path)
        for thing in bpy.context.scene.objects:
            if thing.type != "MESH":
                continue
            mesh = bmesh.new()
            mesh.from_mesh(thing.data)
            mesh.transform(thing.matrix_world)
            bmesh.ops.triangulate(mesh, faces=mesh.faces)
            found["triangles"] += len(mesh.faces)
            found["volume"] += mesh.calc_volume(signed=True)
            found["area"] += sum(face.calc_area() for face in mesh.faces)
            mesh.free()
    except Exception as error:  # whatever an importer throws
        found = {"error": str(error).strip().splitlines()[-1]}
    print("FOUND " + json.dumps({"path": path, **found}), flush=True)
