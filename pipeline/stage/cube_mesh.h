// Meshes on disk that are sorted by cubes, as stitch, refine, seams, mend and remend write them, and what
// stands beside them.
#pragma once

#include <filesystem>

#include "stages/refine/refine_range.h"
#include "storage/artifact/cube_mesh_artifact.h"

namespace voxweld {

// One more surface, or a part of one. Labels ascend. cubes: those of the step that will read it.
void add_pieces(CubeMeshWriter& file, Material label, const RefineMesh& mesh,
                const CubeLattice& cubes);

// As stitch leaves it, which has refined nothing. blocks: by which tiles are planned.
Hash128 finish_stitched(CubeMeshWriter& file, std::span<const BlockRecord> blocks);

// The triangles of one label by blocks, `blocks`.
void add_blocks(Material label, const RefineMesh& mesh, const CubeLattice& blocks,
                std::vector<BlockRecord>& records);
// What is said of these triangles, which intersect others: with how full the cubes are that they are
// at home in. That does not depend on the units.
void add_intersections(Material label, const RefineMesh& mesh,
                       std::span<const std::uint32_t> triangles, const CubeLattice& cubes,
                       std::vector<IntersectionRecord>& records);

}  // namespace voxweld
