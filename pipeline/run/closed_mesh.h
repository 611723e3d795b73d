// Closed meshes from files: what inputs and edits of that kind are made of.
#pragma once

#include <filesystem>
#include <string>

#include "stages/geometry/mesh_boundary.h"
#include "storage/readers/mesh_file.h"

namespace voxweld {

// InputError or FormatError for a file that is missing, damaged or too large for a budget of so
// many bytes, and for a mesh that is not closed; warns where its triangles face inward.
MeshFile read_closed_mesh(const std::filesystem::path& path, std::uint64_t budget);

// Where the mesh is open, the largest holes first: "2 holes (...)". Precondition: it is.
std::string holes_text(const MeshBoundary& boundary);

}  // namespace voxweld
