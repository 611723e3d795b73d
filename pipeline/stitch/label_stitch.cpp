#include "pipeline/stitch/label_stitch.h"

#include <algorithm>
#include <optional>

#include "pipeline/stage/cube_mesh.h"
#include "pipeline/stitch/tile_inputs.h"
#include "stages/refine/retile.h"
#include "storage/artifact/label_shard_artifact.h"
#include "storage/artifact/label_top.h"
#include "storage/artifact/tile_artifact.h"
#include "storage/support/bounded_cache.h"
#include "storage/support/error.h"

namespace voxweld {
namespace {

// The pieces of one label, found through the directories of the shards it is in.
class LabelPieces : public ReadPieces {
 public:
  LabelPieces(const BuildJob& job, LabelShardFiles& files, Material material,
              StitchScratch& scratch, const WorkerContext& worker)
      : ReadPieces(scratch, worker), job_(job), files_(files), material_(material) {}

  // Those in one shard, by brick; null where the brick is not in the grid.
  std::shared_ptr<const std::vector<PieceRecord>> of_shard(Index3 brick) {
    if (!Box3{{}, job_.grid.bricks()}.contains(brick)) return nullptr;
    return shards_.get(morton_encode(job_.grid.shard_of(brick)), [&] {
      return std::make_shared<const std::vector<PieceRecord>>(
          files_.of_brick(brick)->pieces(material_));
    });
  }

 private:
  static constexpr std::size_t most_shards = 64;  // a brick reads of eight

  void read(const CellKey& brick, BrickOctree& out) override {
    const auto piece = find(brick.at);
    if (!piece) throw std::logic_error("stitch: a brick of the tile has no piece");
    files_.of_brick(brick.at)->read_piece(*piece, brick.level, out);
  }
  bool read_ghost_layer(Index3 brick, GhostLayer& out) override {
    const auto piece = find(brick);
    if (!piece) return false;
    files_.of_brick(brick)->read_ghost_layer(*piece, out);
    return true;
  }
  std::optional<PieceRecord> find(Index3 brick) {
    const auto pieces = of_shard(brick);
    if (pieces == nullptr) return std::nullopt;
    const std::uint64_t code = morton_encode(brick);
    const auto at = std::lower_bound(
        pieces->begin(), pieces->end(), code,
        [](const PieceRecord& piece, std::uint64_t c) { return piece.key.brick < c; });
    if (at == pieces->end() || at->key.brick != code) return std::nullopt;
    return *at;
  }

  const BuildJob& job_;
  LabelShardFiles& files_;
  Material material_;
  BoundedCache<std::vector<PieceRecord>> shards_{most_shards};
};

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
    LabelPieces pieces(*job_.build, files_, surface.material, scratch, worker);
    const std::vector<CellKey> bricks = bricks_of(surface, tile, pieces);
    if (collapses_by_sheets(job_.build->parameters))
      return stitch_tile(tile, job_.parameters, bricks,
                         clusters_of(number, surface.material, bricks), pieces);
    return stitch_tile(tile, job_.parameters, bricks, above(surface, bricks), pieces);
  }

  // The bricks with a surface of the label that the tile meets, in Morton order.
  std::vector<CellKey> bricks_of(const SurfaceRecord& surface, const PlannedTile& tile,
                                 LabelPieces& pieces) {
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

  AboveBricks clusters_of(std::uint64_t number, Material material,
                          const std::vector<CellKey>& bricks) {
    return clusters_above(job_.build->grid, bricks, top_.clusters(number),
                          [&](const CellKey& cube, Index3 brick) -> std::optional<ReducedNode> {
                            const auto file = files_.of_brick(brick);
                            return file == nullptr ? std::nullopt : file->clusters(material, cube);
                          });
  }

  std::vector<TopLeaf> above(const SurfaceRecord& surface, const std::vector<CellKey>& bricks) {
    if (surface.leaves == 0) return {};
    return leaves_above(bricks, [&](std::uint64_t begin, std::uint64_t end) {
      return top_.leaves(surface, begin, end);
    });
  }

  LabelTop top_;
  std::vector<BatchRecord> batches_;
  LabelShardFiles files_;
  std::optional<CubeLattice> cubes_;  // where the meshes are refined
};

}  // namespace

std::unique_ptr<StitchWork> label_stitch(const StitchJob& job, const TopArtifact& top) {
  return std::make_unique<LabelStitch>(job, top);
}

}  // namespace voxweld
