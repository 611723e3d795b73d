// Finished meshes as other programs may want them: one vertex a position, in the coordinates of the
// world, with the labels of their triangles.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "stages/encode/mesh_writers.h"

namespace voxweld {

struct WideMesh {
  std::vector<Vec3> positions;
  bool doubles = false;                       // floats do not hold the positions
  std::vector<std::array<float, 3>> normals;  // one a position; empty when there are none
  std::vector<std::array<std::uint32_t, 3>> triangles;
  // One a triangle, or empty. outside: of meshes between labels alone.
  std::vector<Material> labels, labels_outside;
  std::string comment;  // of files that have room for one
};

struct ExportOptions {
  bool weld = false;   // one vertex a position (and label); normals are dropped
  bool world = false;  // the manifest's frame applied
  int level = 0;       // of detail
};

// Of a mesh file, or all of an output directory. With `world` a file needs the manifest of the
// output directory that it lies in. Errors as load_mesh; InputError where there is no manifest, or
// where there are more vertices than 32 bits count.
WideMesh load_wide_mesh(const std::filesystem::path& path, const ExportOptions& options,
                        MeshWriters formats = mesh_writers());

// The whole of a .ply (binary), .obj, .stl (binary) or .off file, by the path's extension. Where positions are doubles, .ply has them as such, .obj and .off with all digits; an .stl
// has floats. Labels go into a .ply only: of each face, as `label` (on its inner side) and
// `label_outside`; -1 is the space around the volume.
std::string exported_wide_mesh(const WideMesh& mesh, const std::filesystem::path& path);

}  // namespace voxweld
