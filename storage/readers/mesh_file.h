// Triangle meshes from STL, OFF, OBJ and PLY files, whole in memory.
#pragma once

#include <filesystem>
#include <string>

#include "storage/support/hash.h"
#include "storage/types/triangle_mesh.h"

namespace voxweld {

struct MeshFile {
  // Corners at equal places are one (STL writes each as often as it is used); polygons are cut into
  // fans; triangles that have a corner twice are gone. All else is as the file has it.
  TriangleMesh mesh;
  Hash128 content;     // of the file's bytes
  std::string format;  // "stl", "off", "obj" or "ply"
};

// Whether the name ends as those of mesh files do.
bool is_mesh_name(const std::filesystem::path& path);

// The format goes by the name's extension; an .stl and a .ply may be text or binary.
// InputError: no such file, or a name of no known format. FormatError: damaged, no triangles, a
// coordinate that is not a finite number.
MeshFile read_mesh_file(const std::filesystem::path& path);

}  // namespace voxweld
