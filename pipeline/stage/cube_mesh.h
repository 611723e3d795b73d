// Meshes on disk that are sorted by cubes, as stitch, refine, seams and mend write them.
#pragma once

#include <filesystem>

#include "stages/refine/refine_range.h"
#include "storage/artifact/cube_mesh_artifact.h"

namespace voxweld {

// One more surface, or a part of one. Labels ascend. cubes: those of the step that will read it.
void add_pieces(CubeMeshWriter& file, Material label, const RefineMesh& mesh,
                const CubeLattice& cubes);

// As stitch leaves it, which has refined nothing.
Hash128 finish_stitched(CubeMeshWriter& file);

}  // namespace voxweld
