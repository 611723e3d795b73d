#include "pipeline/stitch/label_stitch.h"

#include <algorithm>
#include <optional>

#include "pipeline/stage/cube_mesh.h"
#include "pipeline/stitch/tile_inputs.h"
#include "stages/refine/retile.h"
#include "storage/artifact/label_top.h"
#include "storage/artifact/tile_artifact.h"

namespace voxweld {
namespace {

class LabelStitch : public StitchWork {
 public:
  LabelStitch(const StitchJob& job, const TopArtifact& top)
      : StitchWork(job), top_(top), batches_(top_.batches()), files_(*job.build, top) {
    if (job.cubes) cubes_.emplace(*job.cubes, 0);
  }

  // Merge has looked at all it reads.
  Hash128 key(std::uint64_t unit) override {
    return KeyHasher().hash(job_.key).hash(batches_[unit].inputs).finish();
  }
  std::uint64_t brick_bytes(std::uint64_t unit) override {
    // As read and as held, once for the brick and once for its neighbours' ghost layers.
    return 4 * batches_[unit].largest_piece;
  }
  void run(std::uint64_t unit, const std::filesystem::path& path, StitchScratch& scratch,
           WorkerContext& worker) override {
    const auto each_mesh = [&](auto&& f) {
      const BatchRecord& batch = batches_[unit];
      const auto surfaces = top_.surfaces(batch.first_surface, batch.surfaces);
      const auto tiles = top_.tiles(batch.first_tile, batch.tiles);
      for (std::size_t i = 0; i < tiles.size(); ++i)
        f(surfaces[i].material,
          stitched(batch.first_surface + i, surfaces[i], tiles[i], scratch, worker));
    };
    if (!cubes_) {
      LabelTilesWriter out(path, key(unit));
      each_mesh([&](Material label, const TileMesh& mesh) { out.add(label, mesh); });
      out.finish();
      return;
    }
    CubeMeshWriter out(path, key(unit));
    each_mesh([&](Material label, TileMesh mesh) {
      add_pieces(out, label, to_refine_mesh(std::move(mesh)), *cubes_);
    });
    finish_stitched(out);
  }

 private:
  // number: of the surface, among all.
  TileMesh stitched(std::uint64_t number, const SurfaceRecord& surface, const PlannedTile& tile,
                    StitchScratch& scratch, WorkerContext& worker) {
    MaterialPieces pieces(files_, surface.material);
    ReadPieces read(pieces, scratch, worker);
    const std::vector<CellKey> bricks = bricks_of(surface, tile, pieces);
    if (collapses_by_sheets(job_.build->parameters))
      return stitch_tile(tile, job_.parameters, bricks,
                         clusters_above(job_.build->grid, bricks, top_.clusters(number), pieces),
                         read);
    return stitch_tile(tile, job_.parameters, bricks, above(surface, bricks), read);
  }

  // The bricks with a surface of the label that the tile meets, in Morton order.
  std::vector<CellKey> bricks_of(const SurfaceRecord& surface, const PlannedTile& tile,
                                 MaterialPieces& pieces) {
    const BrickGrid& grid = job_.build->grid;
    const int level = grid.brick_level(), cube_level = grid.shard_level();
    const std::uint64_t begin = tile.code, end = begin + (std::uint64_t{1} << (3 * tile.level));
    const auto end_of = [](std::uint64_t code, int l) {
      return code + (std::uint64_t{1} << (3 * l));
    };
    std::vector<CellKey> bricks;
    for (const SurfaceNode& node : top_.nodes(surface, cube_level, begin, end)) {
      const Index3 first = morton_decode(node.code >> (3 * level));
      for (const PieceRecord& piece : *pieces.of_shard(first)) {
        const std::uint64_t code = piece.key.brick << (3 * level);
        const bool in_cube = code >= node.code && code < end_of(node.code, cube_level);
        if (in_cube && code < end && end_of(code, level) > begin)
          bricks.push_back({level, morton_decode(piece.key.brick)});
      }
    }
    return bricks;
  }

  std::vector<TopLeaf> above(const SurfaceRecord& surface, const std::vector<CellKey>& bricks) {
    if (surface.leaves == 0) return {};
    return leaves_above(bricks, [&](std::uint64_t begin, std::uint64_t end) {
      return top_.leaves(surface, begin, end);
    });
  }

  LabelTop top_;
  std::vector<BatchRecord> batches_;
  ShardFiles files_;
  std::optional<CubeLattice> cubes_;  // where the meshes are refined
};

}  // namespace

std::unique_ptr<StitchWork> label_stitch(const StitchJob& job, const TopArtifact& top) {
  return std::make_unique<LabelStitch>(job, top);
}

}  // namespace voxweld
