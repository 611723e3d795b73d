#include "pipeline/stitch/tile_inputs.h"

#include <algorithm>

#include "stages/merge/cluster_reduction.h"
#include "storage/support/error.h"

namespace voxweld {

std::vector<CellKey> tile_bricks(const BrickGrid& grid, CellKey tile, MaterialPieces& pieces) {
  const int level = grid.brick_level();
  const std::int64_t side = std::int64_t{1} << level;
  const Box3 cells = tile.cells();
  Box3 range{{cells.lo.x / side, cells.lo.y / side, cells.lo.z / side},
             {(cells.hi.x + side - 1) / side, (cells.hi.y + side - 1) / side,
              (cells.hi.z + side - 1) / side}};
  range = intersect(range, Box3{{}, grid.bricks()});
  std::vector<std::uint64_t> codes;
  for (std::int64_t z = range.lo.z; z < range.hi.z; ++z)
    for (std::int64_t y = range.lo.y; y < range.hi.y; ++y)
      for (std::int64_t x = range.lo.x; x < range.hi.x; ++x)
        if (pieces.find({x, y, z})) codes.push_back(morton_encode({x, y, z}));
  std::sort(codes.begin(), codes.end());
  std::vector<CellKey> bricks;
  bricks.reserve(codes.size());
  for (const std::uint64_t code : codes) bricks.push_back({level, morton_decode(code)});
  return bricks;
}

AboveBricks clusters_above(const BrickGrid& grid, const std::vector<CellKey>& bricks,
                           const ReducedNode& top, const MaterialPieces& pieces) {
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
    std::optional<ReducedNode> node =
        pieces.clusters(cube, morton_decode(code >> (3 * grid.brick_level())));
    if (!node) continue;
    nodes.push_back(std::make_unique<const ReducedNode>(std::move(*node)));
    found.push_back({last, nodes.back().get()});
  }
  return bricks_above(found, top, codes);
}

TileAbove tile_above(const BuildJob& job, const std::vector<CellKey>& bricks,
                     const TopArtifact& top, const ReducedNode& clusters,
                     const MaterialPieces& pieces) {
  TileAbove above;
  if (collapses_by_sheets(job.parameters))
    above.clusters = clusters_above(job.grid, bricks, clusters, pieces);
  else
    above.leaves = leaves_above(
        bricks, [&](std::uint64_t begin, std::uint64_t end) { return top.leaves(begin, end); });
  return above;
}

Hash128 tile_key(const StitchJob& job, const PlannedTile& tile, const std::vector<CellKey>& bricks,
                 const TileAbove& above, MaterialPieces& pieces) {
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
    const std::optional<PieceRecord> piece = pieces.find(brick.at);
    key.hash(piece->body).hash(piece->ghost);
    for (int d = 1; d < 8; ++d)
      if (const auto upper = pieces.find(upper_neighbour(brick.at, d))) key.hash(upper->ghost);
  }
  return key.finish();
}

std::uint64_t largest_brick_bytes(const std::vector<CellKey>& bricks, MaterialPieces& pieces) {
  std::uint64_t largest = 0;
  for (const CellKey& brick : bricks)
    largest = std::max(largest, pieces.find(brick.at)->stitched_bytes());
  return 2 * largest;
}

}  // namespace voxweld
