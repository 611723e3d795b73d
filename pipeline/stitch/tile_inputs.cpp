#include "pipeline/stitch/tile_inputs.h"

#include "stages/merge/cluster_reduction.h"

namespace voxweld {
namespace {

std::vector<CellKey> bricks_of(const BrickGrid& grid, const MaterialTop& top,
                               const SurfaceRecord& surface, const PlannedTile& tile,
                               MaterialPieces& pieces) {
  const int level = grid.brick_level(), cube_level = grid.shard_level();
  const auto end_of = [](std::uint64_t code, int l) {
    return code + (std::uint64_t{1} << (3 * l));
  };
  const std::uint64_t begin = tile.code, end = end_of(begin, static_cast<int>(tile.level));
  std::vector<CellKey> bricks;
  for (const SurfaceNode& node : top.nodes(surface, cube_level, begin, end)) {
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

}  // namespace

TileInputs tile_inputs(const BuildJob& job, const MaterialTop& top, const SurfaceRecord& surface,
                       const PlannedTile& tile, const ReducedNode& clusters,
                       MaterialPieces& pieces) {
  TileInputs inputs;
  inputs.bricks = bricks_of(job.grid, top, surface, tile, pieces);
  if (collapses_by_sheets(job.parameters))
    inputs.clusters = clusters_above(job.grid, inputs.bricks, clusters, pieces);
  else if (surface.leaves > 0)
    inputs.leaves = leaves_above(inputs.bricks, [&](std::uint64_t begin, std::uint64_t end) {
      return top.leaves(surface, begin, end);
    });
  return inputs;
}

Hash128 tile_key(const StitchJob& job, const PlannedTile& tile, const TileInputs& inputs,
                 MaterialPieces& pieces) {
  KeyHasher key;
  key.hash(job.key).integer(static_cast<std::int64_t>(tile.code)).integer(tile.level);
  key.bytes(std::as_bytes(std::span(inputs.leaves)));
  key.bytes(std::as_bytes(std::span(inputs.clusters.bricks)));
  key.bytes(std::as_bytes(std::span(inputs.clusters.links)));
  key.bytes(std::as_bytes(std::span(inputs.clusters.leaves)));
  for (const CellKey& brick : inputs.bricks) {
    key.integer(static_cast<std::int64_t>(brick.code()));
    const std::optional<PieceRecord> piece = pieces.find(brick.at);
    key.hash(piece->body).hash(piece->ghost);
    for (int d = 1; d < 8; ++d)
      if (const auto upper = pieces.find(upper_neighbour(brick.at, d))) key.hash(upper->ghost);
  }
  return key.finish();
}

}  // namespace voxweld
