// Meshes in the formats OpenMesh writes, for other programs.
#pragma once

#include <filesystem>

#include "stages/encode/draco_codec.h"

namespace voxweld {

// Writes .ply (binary), .obj, .stl (binary) or .off by the path's extension, through a temporary
// name. Coordinates are those of the mesh's frame and unit, exact where the format is binary or
// prints enough digits; normals are written for .ply, .obj and .off where the mesh has them.
// InputError for another extension, StorageError when the file cannot be written.
void export_mesh(const DecodedMesh& mesh, const std::filesystem::path& path);

}  // namespace voxweld
