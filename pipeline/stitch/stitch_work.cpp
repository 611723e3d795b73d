#include "pipeline/stitch/stitch_work.h"

#include <utility>

#include "pipeline/stage/cube_mesh.h"
#include "pipeline/stitch/label_stitch.h"
#include "pipeline/stitch/tile_inputs.h"
#include "stages/refine/retile.h"
#include "storage/artifact/tile_artifact.h"

namespace voxweld {
namespace {

// One surface: a unit a tile, its bricks in the shards' artifacts.
class TileStitch : public StitchWork {
 public:
  TileStitch(const StitchJob& job, const TopArtifact& top)
      : StitchWork(job),
        top_(top),
        tiles_(top.tiles()),
        clusters_(top.clusters()),
        files_(*job.build, top) {}

  Hash128 key(std::uint64_t unit) override {
    MaterialPieces pieces(files_, sole_material);
    return prepare(unit, pieces).key;
  }
  std::uint64_t bytes() const override { return top_.cluster_bytes(); }
  std::uint64_t brick_bytes(std::uint64_t unit) override {
    MaterialPieces pieces(files_, sole_material);
    return largest_brick_bytes(tile_bricks(job_.build->grid, tiles_[unit].key(), pieces), pieces);
  }
  void run(std::uint64_t unit, const std::filesystem::path& path, StitchScratch& scratch,
           WorkerContext& worker) override {
    MaterialPieces pieces(files_, sole_material);
    const Inputs inputs = prepare(unit, pieces);
    ReadPieces read(pieces, scratch, worker);
    TileMesh mesh = stitched(tiles_[unit], inputs, read);
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
  Inputs prepare(std::uint64_t unit, MaterialPieces& pieces) {
    Inputs inputs;
    inputs.bricks = tile_bricks(job_.build->grid, tiles_[unit].key(), pieces);
    inputs.above = tile_above(*job_.build, inputs.bricks, top_, clusters_, pieces);
    inputs.key = tile_key(job_, tiles_[unit], inputs.bricks, inputs.above, pieces);
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

std::unique_ptr<StitchWork> stitch_work(const StitchJob& job, const TopArtifact& top) {
  if (job.build->parameters.labels.mode == LabelMode::each) return label_stitch(job, top);
  return std::make_unique<TileStitch>(job, top);
}

}  // namespace voxweld
