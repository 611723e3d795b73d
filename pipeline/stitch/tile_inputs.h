// What one tile's stitching reads: its bricks, their upper neighbours' skins, its part of the top
// tree.
#pragma once

#include <functional>
#include <list>
#include <map>
#include <memory>
#include <mutex>

#include "pipeline/stitch/stitch_stage.h"
#include "storage/artifact/label_shard_artifact.h"
#include "storage/artifact/shard_artifact.h"

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
  std::mutex mutex_;
  std::map<std::uint64_t, std::shared_ptr<const Artifact>> open_;
  std::list<std::uint64_t> order_;  // oldest first
};
using ShardFiles = OpenShards<ShardArtifact>;
using LabelShardFiles = OpenShards<LabelShardArtifact>;

// The brick one further on each axis whose bit is set in `direction` (1 .. 7).
constexpr Index3 upper_neighbour(Index3 brick, int direction) {
  return brick + Index3{direction & 1, direction >> 1 & 1, direction >> 2};
}

// The bricks with a surface that a tile's cube meets, in Morton order.
std::vector<CellKey> tile_bricks(const BuildJob& job, CellKey tile, ShardFiles& files);

// The Morton range of finest cells that the tile's bricks and their upper neighbours lie in is not
// one interval: the leaves above them are looked up brick by brick. leaves(begin, end): those that
// meet the range, in order.
std::vector<TopLeaf> leaves_above(
    const BrickGrid& grid, const std::vector<CellKey>& bricks,
    const std::function<std::vector<TopLeaf>(std::uint64_t, std::uint64_t)>& leaves);
std::vector<TopLeaf> leaves_above(const BuildJob& job, const std::vector<CellKey>& bricks,
                                  const TopArtifact& top);

Hash128 tile_key(const StitchJob& job, const PlannedTile& tile, const std::vector<CellKey>& bricks,
                 const std::vector<TopLeaf>& above, ShardFiles& files);

// The most bytes the parts of one of these bricks take, its neighbours' skins included.
std::uint64_t largest_brick_bytes(const std::vector<CellKey>& bricks, ShardFiles& files);

}  // namespace voxweld
