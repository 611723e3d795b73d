// What one tile's stitching reads: its bricks, their upper neighbours' ghost layers, its part of
// the top tree.
#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "pipeline/stitch/stitch_stage.h"
#include "stages/stitch/stitch_tile.h"
#include "storage/artifact/label_shard_artifact.h"
#include "storage/artifact/shard_artifact.h"
#include "storage/support/bounded_cache.h"

namespace voxweld {

// Opened octree artifacts, a bounded number of them. Thread-safe.
template <class Artifact>
class OpenShards {
 public:
  OpenShards(const BuildJob& job, const TopArtifact& top);
  // The artifact of the shard that builds this brick; null when the brick is not in the grid.
  // DamagedArtifact naming the top tree when that was merged from another than lies there now.
  std::shared_ptr<const Artifact> of_brick(Index3 brick);

 private:
  static constexpr std::size_t most_open = 128;
  Hash128 merged_hash(Index3 shard) const;

  const BuildJob& job_;
  std::string top_path_;
  std::vector<std::uint64_t> codes_;  // of the shards, ascending
  std::vector<Hash128> merged_;       // beside them: the content hashes the top tree has
  BoundedCache<Artifact> open_{most_open};
};
using ShardFiles = OpenShards<ShardArtifact>;
using LabelShardFiles = OpenShards<LabelShardArtifact>;

// The bricks with a surface that a tile's cube meets, in Morton order.
std::vector<CellKey> tile_bricks(const BuildJob& job, CellKey tile, ShardFiles& files);

// What lies above them and their upper neighbours: one of the two, as the job collapses.
struct TileAbove {
  std::vector<TopLeaf> leaves;
  AboveBricks clusters;  // where each sheet collapses by itself
};
// The latter: of the bricks' shards, each looked up by its cube and one of its bricks, and of top.
using ClusterLookup = std::function<std::optional<ReducedNode>(const CellKey& cube, Index3 brick)>;
AboveBricks clusters_above(const BrickGrid& grid, const std::vector<CellKey>& bricks,
                           const ReducedNode& top, const ClusterLookup& shards);
// clusters: those of `top`.
TileAbove tile_above(const BuildJob& job, const std::vector<CellKey>& bricks,
                     const TopArtifact& top, const ReducedNode& clusters, ShardFiles& files);

Hash128 tile_key(const StitchJob& job, const PlannedTile& tile, const std::vector<CellKey>& bricks,
                 const TileAbove& above, ShardFiles& files);

// The most bytes the parts of one of these bricks take, its neighbours' ghost layers included.
std::uint64_t largest_brick_bytes(const std::vector<CellKey>& bricks, ShardFiles& files);

}  // namespace voxweld
