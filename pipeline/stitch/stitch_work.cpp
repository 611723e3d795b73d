#include "pipeline/stitch/stitch_work.h"

#include "pipeline/stitch/label_stitch.h"
#include "pipeline/stitch/tile_inputs.h"
#include "storage/artifact/tile_artifact.h"

namespace voxweld {
namespace {

// The polygons of the brick whose owner cells lie in the tile: all, or those of some 16^3 blocks.
void cut_to_tile(const PlannedTile& tile, const BrickOctree& octree, StitchBrick& brick) {
  if (static_cast<int>(tile.level) >= brick.key.level) return;
  const std::uint64_t first = (tile.code - brick.key.code()) >> (3 * block_level);
  const std::uint64_t count = std::uint64_t{1}
                              << (3 * (static_cast<int>(tile.level) - block_level));
  const std::size_t begin = first == 0 ? 0 : octree.blocks[first - 1].polygon_end;
  const std::size_t end = octree.blocks[first + count - 1].polygon_end;
  brick.polygons = brick.polygons.subspan(begin, end - begin);
  if (!brick.polygon_pairs.empty())
    brick.polygon_pairs = brick.polygon_pairs.subspan(begin, end - begin);
  if (!brick.emit_levels.empty()) brick.emit_levels = brick.emit_levels.subspan(begin, end - begin);
}

// One surface: a unit a tile, its bricks in the shards' artifacts.
class TileStitch : public StitchWork, private BrickPieces {
 public:
  TileStitch(const StitchJob& job, const TopArtifact& top)
      : job_(job), top_(top), tiles_(top.tiles()), files_(*job.build, top) {}

  Hash128 key(std::uint64_t unit) override { return prepare(unit).key; }
  std::uint64_t brick_bytes(std::uint64_t unit) override {
    return largest_brick_bytes(tile_bricks(*job_.build, tiles_[unit].key(), files_), files_);
  }
  void run(std::uint64_t unit, const std::filesystem::path& path, StitchScratch& scratch,
           WorkerContext& worker) override {
    const Inputs inputs = prepare(unit);
    write_tile(
        path, inputs.key,
        stitch_tile(job_, tiles_[unit], inputs.bricks, inputs.above, *this, scratch, worker));
  }

 private:
  struct Inputs {
    std::vector<CellKey> bricks;
    std::vector<TopLeaf> above;
    Hash128 key;
  };
  Inputs prepare(std::uint64_t unit) {
    Inputs inputs;
    inputs.bricks = tile_bricks(*job_.build, tiles_[unit].key(), files_);
    inputs.above = leaves_above(*job_.build, inputs.bricks, top_);
    inputs.key = tile_key(job_, tiles_[unit], inputs.bricks, inputs.above, files_);
    return inputs;
  }
  void read(const CellKey& brick, BrickOctree& out) override {
    files_.of_brick(brick.at)->read_brick(morton_encode(brick.at), out);
  }
  bool read_skin(Index3 brick, Skin& out) override {
    const auto file = files_.of_brick(brick);
    if (file == nullptr || !file->has_brick(morton_encode(brick))) return false;
    file->read_skin(morton_encode(brick), out);
    return true;
  }

  const StitchJob& job_;
  const TopArtifact& top_;
  std::vector<PlannedTile> tiles_;
  ShardFiles files_;
};

}  // namespace

TileMesh stitch_tile(const StitchJob& job, const PlannedTile& tile, std::span<const CellKey> bricks,
                     std::span<const TopLeaf> above, BrickPieces& pieces, StitchScratch& scratch,
                     WorkerContext& worker) {
  TileStitcher stitcher(tile.key(), job.parameters, above);
  for (const CellKey& key : bricks) {
    worker.check_interrupt();
    pieces.read(key, scratch.brick);
    StitchBrick brick{key,
                      scratch.brick.vertices,
                      scratch.brick.polygons,
                      scratch.brick.emit_levels,
                      scratch.brick.pairs,
                      scratch.brick.polygon_pairs,
                      &scratch.brick.skin,
                      {}};
    for (std::size_t d = 1; d < 8; ++d)
      if (pieces.read_skin(upper_neighbour(key.at, static_cast<int>(d)), scratch.upper[d]))
        brick.upper[d] = &scratch.upper[d];
    cut_to_tile(tile, scratch.brick, brick);
    stitcher.add(brick);
  }
  return stitcher.finish();
}

std::unique_ptr<StitchWork> stitch_work(const StitchJob& job, const TopArtifact& top) {
  if (job.build->parameters.labels.mode == LabelMode::each) return label_stitch(job, top);
  return std::make_unique<TileStitch>(job, top);
}

}  // namespace voxweld
