// Finished meshes back into memory.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>

#include "stages/encode/mesh_writers.h"
#include "storage/types/material_table.h"

namespace voxweld {

// A file of one of the formats, known by its ending. InputError for another ending, FormatError for
// a damaged file.
DecodedMesh load_mesh(const std::filesystem::path& path, MeshWriters formats = mesh_writers());

// The files that for_each_mesh reads, in its order. level: of detail, in an output directory; 0 is the
// mesh itself. InputError where there is none of that number.
void each_mesh_file(
    const std::filesystem::path& path,
    const std::function<void(const std::filesystem::path&, std::optional<Material> label)>& f,
    int level = 0);

// Of an output directory each tile (or the merged mesh where there are no tiles), one after the
// other; of a file its mesh. label: of a mesh that is one label's (labels.mode = "each"); a coarse tile has
// one for each of its labels.
void for_each_mesh(const std::filesystem::path& path,
                   const std::function<void(const DecodedMesh&, std::optional<Material> label)>& f,
                   MeshWriters formats = mesh_writers(), int level = 0);

// The colours that labels.jsonl of an output directory lists; none of other files.
MaterialTable listed_colours(const std::filesystem::path& path);

}  // namespace voxweld
