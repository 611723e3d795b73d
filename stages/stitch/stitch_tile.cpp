#include "stages/stitch/stitch_tile.h"

#include <algorithm>

namespace voxweld {
namespace {

// The polygons of the brick whose owner cells lie in the tile: all, or those of some 16^3 blocks.
void cut_to_tile(const PlannedTile& tile, std::span<const BlockCount> blocks, StitchBrick& brick) {
  if (static_cast<int>(tile.level) >= brick.key.level) return;
  const std::uint64_t first = (tile.code - brick.key.code()) >> (3 * block_level);
  const std::uint64_t count = std::uint64_t{1}
                              << (3 * (static_cast<int>(tile.level) - block_level));
  const std::size_t begin = first == 0 ? 0 : blocks[first - 1].polygon_end;
  const std::size_t end = blocks[first + count - 1].polygon_end;
  brick.polygons = brick.polygons.subspan(begin, end - begin);
  if (!brick.polygon_pairs.empty())
    brick.polygon_pairs = brick.polygon_pairs.subspan(begin, end - begin);
  if (!brick.emit_levels.empty()) brick.emit_levels = brick.emit_levels.subspan(begin, end - begin);
}

}  // namespace

std::vector<std::uint64_t> codes_read(std::span<const CellKey> bricks) {
  std::vector<std::uint64_t> codes;
  for (const CellKey& brick : bricks)
    for (int d = 0; d < 8; ++d)
      codes.push_back(CellKey{brick.level, upper_neighbour(brick.at, d)}.code());
  std::sort(codes.begin(), codes.end());
  codes.erase(std::unique(codes.begin(), codes.end()), codes.end());
  return codes;
}

std::vector<TopLeaf> leaves_above(std::span<const CellKey> bricks, const LeafLookup& leaves) {
  std::vector<TopLeaf> found;
  if (bricks.empty()) return found;
  const std::uint64_t cells = std::uint64_t{1} << (3 * bricks[0].level);
  const std::vector<std::uint64_t> codes = codes_read(bricks);
  // Neighbouring codes are asked for together.
  for (std::size_t i = 0; i < codes.size();) {
    std::size_t j = i + 1;
    while (j < codes.size() && codes[j] == codes[j - 1] + cells) ++j;
    for (const TopLeaf& leaf : leaves(codes[i], codes[j - 1] + cells))
      if (found.empty() || found.back().code < leaf.code) found.push_back(leaf);
    i = j;
  }
  return found;
}

namespace {

TileMesh stitch(const PlannedTile& tile, TileStitcher& stitcher, std::span<const CellKey> bricks,
                BrickPieces& pieces) {
  for (const CellKey& key : bricks) {
    const BrickOctree& octree = pieces.brick(key);
    StitchBrick brick{key,
                      octree.vertices,
                      octree.roots,
                      octree.polygons,
                      octree.emit_levels,
                      octree.pairs,
                      octree.polygon_pairs,
                      &octree.ghost,
                      {}};
    for (int d = 1; d < 8; ++d)
      brick.upper[static_cast<std::size_t>(d)] = pieces.ghost(upper_neighbour(key.at, d), d);
    cut_to_tile(tile, octree.blocks, brick);
    stitcher.add(brick);
  }
  return stitcher.finish();
}

}  // namespace

TileMesh stitch_tile(const PlannedTile& tile, const StitchParameters& parameters,
                     std::span<const CellKey> bricks, std::span<const TopLeaf> above,
                     BrickPieces& pieces) {
  TileStitcher stitcher(tile.key(), parameters, above);
  return stitch(tile, stitcher, bricks, pieces);
}

TileMesh stitch_tile(const PlannedTile& tile, const StitchParameters& parameters,
                     std::span<const CellKey> bricks, const AboveBricks& above,
                     BrickPieces& pieces) {
  TileStitcher stitcher(tile.key(), parameters, {}, &above);
  return stitch(tile, stitcher, bricks, pieces);
}

}  // namespace voxweld
