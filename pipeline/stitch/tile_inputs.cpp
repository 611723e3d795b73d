#include "pipeline/stitch/tile_inputs.h"

#include <algorithm>

#include "stages/merge/cluster_reduction.h"
#include "storage/support/error.h"

namespace voxweld {

template <class Artifact>
OpenShards<Artifact>::OpenShards(const BuildJob& job, const TopArtifact& top)
    : job_(job), top_path_(top.path()), merged_(top.shards()) {
  for (const Index3& shard : job.grid.all_shards()) codes_.push_back(morton_encode(shard));
  if (merged_.size() != codes_.size()) throw DamagedArtifact(top_path_, "is of other shards");
}

template <class Artifact>
Hash128 OpenShards<Artifact>::merged_hash(Index3 shard) const {
  const auto at = std::lower_bound(codes_.begin(), codes_.end(), morton_encode(shard));
  return merged_[static_cast<std::size_t>(at - codes_.begin())];
}

template <class Artifact>
std::shared_ptr<const Artifact> OpenShards<Artifact>::of_brick(Index3 brick) {
  if (!Box3{{}, job_.grid.bricks()}.contains(brick)) return nullptr;
  const Index3 shard = job_.grid.shard_of(brick);
  return open_.get(morton_encode(shard), [&] {
    auto file = std::make_shared<const Artifact>(shard_artifact_path(job_, shard));
    if (file->key() != shard_key(job_, shard))
      throw DamagedArtifact(file->path(), "is of other parameters");
    if (file->content_hash() != merged_hash(shard))
      throw DamagedArtifact(top_path_,
                            "was merged from another " + file->path() + " than is there");
    return file;
  });
}

template class OpenShards<ShardArtifact>;
template class OpenShards<LabelShardArtifact>;

std::vector<CellKey> tile_bricks(const BuildJob& job, CellKey tile, ShardFiles& files) {
  const int level = job.grid.brick_level();
  const std::int64_t side = std::int64_t{1} << level;
  const Box3 cells = tile.cells();
  Box3 range{{cells.lo.x / side, cells.lo.y / side, cells.lo.z / side},
             {(cells.hi.x + side - 1) / side, (cells.hi.y + side - 1) / side,
              (cells.hi.z + side - 1) / side}};
  range = intersect(range, Box3{{}, job.grid.bricks()});
  std::vector<std::uint64_t> codes;
  for (std::int64_t z = range.lo.z; z < range.hi.z; ++z)
    for (std::int64_t y = range.lo.y; y < range.hi.y; ++y)
      for (std::int64_t x = range.lo.x; x < range.hi.x; ++x) {
        const std::uint64_t code = morton_encode({x, y, z});
        if (files.of_brick({x, y, z})->has_brick(code)) codes.push_back(code);
      }
  std::sort(codes.begin(), codes.end());
  std::vector<CellKey> bricks;
  bricks.reserve(codes.size());
  for (const std::uint64_t code : codes) bricks.push_back({level, morton_decode(code)});
  return bricks;
}

AboveBricks clusters_above(const BrickGrid& grid, const std::vector<CellKey>& bricks,
                           const ReducedNode& top, const ClusterLookup& shards) {
  const int level = grid.shard_level();
  const std::vector<std::uint64_t> codes = codes_read(bricks);
  std::vector<std::unique_ptr<const ReducedNode>> nodes;
  std::vector<ShardClusters> found;
  std::uint64_t last = ~std::uint64_t{0};
  for (const std::uint64_t code : codes) {
    // Codes ascend, so the bricks of one cube follow each other.
    const CellKey cube{level, morton_decode(code >> (3 * level))};
    if (cube.code() == last) continue;
    last = cube.code();
    std::optional<ReducedNode> node = shards(cube, morton_decode(code >> (3 * grid.brick_level())));
    if (!node) continue;
    nodes.push_back(std::make_unique<const ReducedNode>(std::move(*node)));
    found.push_back({last, nodes.back().get()});
  }
  return bricks_above(found, top, codes);
}

TileAbove tile_above(const BuildJob& job, const std::vector<CellKey>& bricks,
                     const TopArtifact& top, const ReducedNode& clusters, ShardFiles& files) {
  TileAbove above;
  if (collapses_by_sheets(job.parameters))
    above.clusters =
        clusters_above(job.grid, bricks, clusters,
                       [&](const CellKey& cube, Index3 brick) -> std::optional<ReducedNode> {
                         const auto file = files.of_brick(brick);
                         return file == nullptr ? std::nullopt : file->clusters(cube);
                       });
  else
    above.leaves = leaves_above(
        bricks, [&](std::uint64_t begin, std::uint64_t end) { return top.leaves(begin, end); });
  return above;
}

Hash128 tile_key(const StitchJob& job, const PlannedTile& tile, const std::vector<CellKey>& bricks,
                 const TileAbove& above, ShardFiles& files) {
  KeyHasher key;
  key.hash(job.key).integer(static_cast<std::int64_t>(tile.code)).integer(tile.level);
  key.bytes(std::as_bytes(std::span(above.leaves)));
  if (collapses_by_sheets(job.build->parameters)) {
    key.bytes(std::as_bytes(std::span(above.clusters.bricks)));
    key.bytes(std::as_bytes(std::span(above.clusters.links)));
    key.bytes(std::as_bytes(std::span(above.clusters.leaves)));
  }
  for (const CellKey& brick : bricks) {
    key.integer(static_cast<std::int64_t>(brick.code()));
    files.of_brick(brick.at)->add_brick_hashes(morton_encode(brick.at), key);
    for (int d = 1; d < 8; ++d) {
      const Index3 at = upper_neighbour(brick.at, d);
      if (const auto file = files.of_brick(at)) file->add_ghost_hashes(morton_encode(at), key);
    }
  }
  return key.finish();
}

std::uint64_t largest_brick_bytes(const std::vector<CellKey>& bricks, ShardFiles& files) {
  std::uint64_t largest = 0;
  for (const CellKey& brick : bricks)
    largest = std::max(largest, files.of_brick(brick.at)->brick_bytes(morton_encode(brick.at)));
  return 2 * largest;
}

}  // namespace voxweld
