// Meshes on disk that are sorted by cubes, as stitch, refine and seams write them.
#pragma once

#include <filesystem>

#include "stages/refine/refine_range.h"
#include "storage/artifact/cube_mesh_artifact.h"

namespace voxweld {

// cubes: those of the step that will read it.
void write_cube_mesh(const std::filesystem::path& path, Hash128 key, const RefineMesh& mesh,
                     const CubeLattice& cubes, const RefineCounts& counts = {},
                     std::span<const CubeCount> blocks = {});

}  // namespace voxweld
