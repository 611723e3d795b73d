// Meshes in the formats OpenMesh writes, for other programs.
#pragma once

#include <filesystem>
#include <string>

#include "pipeline/executor/interrupt.h"
#include "stages/encode/draco_codec.h"

namespace voxweld {

// InputError for a name that ends in none of .ply, .obj, .stl and .off.
void check_export_name(const std::filesystem::path& path);

// The whole of a .ply (binary), .obj, .stl (binary) or .off file, as the path's ending says.
// Coordinates are those of the mesh's frame and unit, exact where the format is binary or
// prints enough digits; normals are in .ply, .obj and .off where the mesh has them.
// InputError as check_export_name.
std::string exported_mesh(const DecodedMesh& mesh, const std::filesystem::path& path);

// Through a temporary name. interrupt: asked between pieces; may be null. StorageError when the
// file cannot be written.
void write_exported(const std::filesystem::path& path, const std::string& text,
                    const InterruptFlag* interrupt = nullptr);

}  // namespace voxweld
