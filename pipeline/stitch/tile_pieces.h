// The octrees that stitching reads: opened artifacts, and in them the pieces of one material.
#pragma once

#include <array>
#include <memory>
#include <optional>

#include "pipeline/stage/artifacts.h"
#include "pipeline/stage/context.h"
#include "stages/stitch/stitch_tile.h"
#include "storage/artifact/shard_artifact.h"
#include "storage/artifact/top_artifact.h"
#include "storage/support/bounded_cache.h"

namespace voxweld {

// Opened octree artifacts, a bounded number of them. Thread-safe.
class ShardFiles {
 public:
  ShardFiles(const BuildJob& job, const TopArtifact& top);
  const BuildJob& job() const { return job_; }
  // The artifact of the shard that builds this brick; null when the brick is not in the grid.
  // DamagedArtifact naming the top tree when that was merged from another than lies there now.
  std::shared_ptr<const ShardArtifact> of_brick(Index3 brick);

 private:
  static constexpr std::size_t most_open = 128;
  Hash128 merged_hash(Index3 shard) const;

  const BuildJob& job_;
  std::string top_path_;
  std::vector<std::uint64_t> codes_;  // of the shards, ascending
  std::vector<Hash128> merged_;       // beside them: the content hashes the top tree has
  BoundedCache<ShardArtifact> open_{most_open};
};

// The pieces of one material, found through the directories of the shards it is in.
class MaterialPieces {
 public:
  MaterialPieces(ShardFiles& files, Material material) : files_(files), material_(material) {}

  // Those in the shard of the brick, by brick; null where that is not in the grid.
  std::shared_ptr<const std::vector<PieceRecord>> of_shard(Index3 brick);
  // Nothing where the brick has no surface.
  std::optional<PieceRecord> find(Index3 brick);
  // False where there is none.
  bool read(Index3 brick, BrickOctree& out);
  bool read_ghost_layer(Index3 brick, GhostLayer& out);
  // What has become of the clusters in this cube of a shard. brick: one in the cube.
  std::optional<ReducedNode> clusters(const CellKey& cube, Index3 brick) const;

 private:
  static constexpr std::size_t most_shards = 64;  // a brick reads of eight

  ShardFiles& files_;
  Material material_;
  BoundedCache<std::vector<PieceRecord>> shards_{most_shards};
};

// A worker's brick and its neighbours' ghost layers, reused.
struct StitchScratch {
  BrickOctree brick;
  std::array<GhostLayer, 8> upper;
};

// Pieces that are read when they are asked for, into a worker's scratch; the worker is asked to
// stop before each brick.
class ReadPieces final : public BrickPieces {
 public:
  ReadPieces(MaterialPieces& pieces, StitchScratch& scratch, const WorkerContext& worker)
      : pieces_(pieces), scratch_(scratch), worker_(worker) {}

  const BrickOctree& brick(const CellKey& key) override;
  const GhostLayer* ghost(Index3 brick, int direction) override;

 private:
  MaterialPieces& pieces_;
  StitchScratch& scratch_;
  const WorkerContext& worker_;
};

}  // namespace voxweld
