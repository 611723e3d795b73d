// Finished meshes back into memory.
#pragma once

#include <filesystem>
#include <functional>

#include "stages/encode/draco_codec.h"

namespace voxweld {

// A .drc or .glb file. InputError for another ending, FormatError for a damaged file.
DecodedMesh load_mesh(const std::filesystem::path& path);

// Of an output directory each tile (or the merged mesh where there are no tiles), one after the
// other; of a file its mesh.
void for_each_mesh(const std::filesystem::path& path,
                   const std::function<void(const DecodedMesh&)>& f);

}  // namespace voxweld
