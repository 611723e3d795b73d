#include "pipeline/stage/cube_mesh.h"

#include <map>

#include "stages/refine/mesh_part.h"
#include "stages/refine/retile.h"

namespace voxweld {

void add_pieces(CubeMeshWriter& file, Material label, const RefineMesh& mesh,
                const CubeLattice& cubes) {
  each_piece(mesh, cubes, [&](const CubePiece& piece) {
    file.piece({label, piece.code}, piece.cube, piece.inside, piece.leaving);
  });
}

Hash128 finish_stitched(CubeMeshWriter& file, std::span<const BlockRecord> blocks) {
  return file.finish({as_record(RefineCounts{}), blocks});
}

void add_blocks(Material label, const RefineMesh& mesh, const CubeLattice& blocks,
                std::vector<BlockRecord>& records) {
  for (const CubeCount& block : count_blocks(mesh, blocks))
    records.push_back({label, block.code, block.polygons});
}

void add_intersections(Material label, const RefineMesh& mesh,
                       std::span<const std::uint32_t> triangles, const CubeLattice& cubes,
                       std::vector<IntersectionRecord>& records) {
  if (triangles.empty()) return;
  std::map<std::uint64_t, std::uint64_t> at_home;  // by the cube's Morton number
  NearbyCubes nearby(cubes);
  auto last = at_home.end();
  for (const auto& corners : mesh.triangles) {
    if (nearby.moves_to(mesh.positions[corners[0]]) || last == at_home.end())
      last = at_home.try_emplace(morton_encode(nearby.cube())).first;
    ++last->second;
  }
  for (const std::uint32_t t : triangles)
    records.push_back({label, mesh.box(t), at_home[morton_encode(home_of(mesh, t, cubes))]});
}

}  // namespace voxweld
