#include "pipeline/stage/cube_mesh.h"

#include "stages/refine/mesh_part.h"

namespace voxweld {

void write_cube_mesh(const std::filesystem::path& path, Hash128 key, const RefineMesh& mesh,
                     const CubeLattice& cubes, const RefineCounts& counts,
                     std::span<const CubeCount> blocks) {
  CubeMeshWriter file(path, key);
  each_piece(mesh, cubes, [&](const CubePiece& piece) {
    file.piece(piece.code, piece.cube, piece.inside, piece.leaving);
  });
  file.finish(as_record(counts), blocks);
}

}  // namespace voxweld
