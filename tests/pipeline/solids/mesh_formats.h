// Meshes written in every format that is read.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "storage/types/triangle_mesh.h"

namespace voxweld::testing {

// "a.off", "a.obj", "text.ply", "little.ply", "big.ply", "text.stl", "binary.stl"
const std::vector<std::string>& mesh_file_names();

// As the name says: one of those. Coordinates are exact but in STL, which has floats.
void write_mesh(const std::filesystem::path& path, const TriangleMesh& mesh);

}  // namespace voxweld::testing
