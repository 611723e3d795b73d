#include "pipeline/stage/cube_mesh.h"

#include "stages/refine/mesh_part.h"

namespace voxweld {

void add_pieces(CubeMeshWriter& file, Material label, const RefineMesh& mesh,
                const CubeLattice& cubes) {
  each_piece(mesh, cubes, [&](const CubePiece& piece) {
    file.piece({label, piece.code}, piece.cube, piece.inside, piece.leaving);
  });
}

Hash128 finish_stitched(CubeMeshWriter& file) {
  return file.finish({as_record(RefineCounts{})});
}

}  // namespace voxweld
