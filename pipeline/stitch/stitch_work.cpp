#include "pipeline/stitch/stitch_work.h"

#include <utility>

#include "pipeline/stage/cube_mesh.h"
#include "pipeline/stitch/label_stitch.h"
#include "pipeline/stitch/tile_inputs.h"
#include "stages/refine/retile.h"
#include "storage/artifact/tile_artifact.h"

namespace voxweld {
namespace {

class SurfacePieces : public ReadPieces {
 public:
  SurfacePieces(ShardFiles& files, StitchScratch& scratch, const WorkerContext& worker)
      : ReadPieces(scratch, worker), files_(files) {}

 private:
  void read(const CellKey& brick, BrickOctree& out) override {
    files_.of_brick(brick.at)->read_brick(morton_encode(brick.at), out);
  }
  bool read_ghost_layer(Index3 brick, GhostLayer& out) override {
    const auto file = files_.of_brick(brick);
    if (file == nullptr || !file->has_brick(morton_encode(brick))) return false;
    file->read_ghost_layer(morton_encode(brick), out);
    return true;
  }

  ShardFiles& files_;
};

// One surface: a unit a tile, its bricks in the shards' artifacts.
class TileStitch : public StitchWork {
 public:
  TileStitch(const StitchJob& job, const TopArtifact& top)
      : StitchWork(job),
        top_(top),
        tiles_(top.tiles()),
        clusters_(top.clusters()),
        files_(*job.build, top) {}

  Hash128 key(std::uint64_t unit) override { return prepare(unit).key; }
  std::uint64_t bytes() const override { return top_.cluster_bytes(); }
  std::uint64_t brick_bytes(std::uint64_t unit) override {
    return largest_brick_bytes(tile_bricks(*job_.build, tiles_[unit].key(), files_), files_);
  }
  void run(std::uint64_t unit, const std::filesystem::path& path, StitchScratch& scratch,
           WorkerContext& worker) override {
    const Inputs inputs = prepare(unit);
    SurfacePieces pieces(files_, scratch, worker);
    TileMesh mesh = stitched(tiles_[unit], inputs, pieces);
    if (!job_.cubes) {
      write_tile(path, inputs.key, mesh);
      return;
    }
    CubeMeshWriter out(path, inputs.key);
    add_pieces(out, 0, to_refine_mesh(std::move(mesh)), CubeLattice(*job_.cubes, 0));
    finish_stitched(out);
  }

 private:
  struct Inputs {
    std::vector<CellKey> bricks;
    TileAbove above;
    Hash128 key;
  };
  Inputs prepare(std::uint64_t unit) {
    Inputs inputs;
    inputs.bricks = tile_bricks(*job_.build, tiles_[unit].key(), files_);
    inputs.above = tile_above(*job_.build, inputs.bricks, top_, clusters_, files_);
    inputs.key = tile_key(job_, tiles_[unit], inputs.bricks, inputs.above, files_);
    return inputs;
  }
  TileMesh stitched(const PlannedTile& tile, const Inputs& inputs, BrickPieces& pieces) const {
    const TileAbove& above = inputs.above;
    if (collapses_by_sheets(job_.build->parameters))
      return stitch_tile(tile, job_.parameters, inputs.bricks, above.clusters, pieces);
    return stitch_tile(tile, job_.parameters, inputs.bricks, above.leaves, pieces);
  }

  const TopArtifact& top_;
  std::vector<PlannedTile> tiles_;
  ReducedNode clusters_;  // of top_
  ShardFiles files_;
};

}  // namespace

Hash128 StitchWork::key_of(const std::filesystem::path& path) const {
  return job_.cubes ? CubeMeshArtifact(path).key() : TileArtifact(path).key();
}

const BrickOctree& ReadPieces::brick(const CellKey& key) {
  worker_.check_interrupt();
  read(key, scratch_.brick);
  return scratch_.brick;
}

const GhostLayer* ReadPieces::ghost(Index3 brick, int direction) {
  GhostLayer& ghost = scratch_.upper[static_cast<std::size_t>(direction)];
  return read_ghost_layer(brick, ghost) ? &ghost : nullptr;
}

std::unique_ptr<StitchWork> stitch_work(const StitchJob& job, const TopArtifact& top) {
  if (job.build->parameters.labels.mode == LabelMode::each) return label_stitch(job, top);
  return std::make_unique<TileStitch>(job, top);
}

}  // namespace voxweld
