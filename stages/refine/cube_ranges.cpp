#include "stages/refine/cube_ranges.h"

namespace voxweld {

namespace {

// Each in eight, where there are cubes of refine in it.
std::vector<PlannedTile> cut(const std::vector<PlannedTile>& tiles, std::uint32_t level) {
  std::vector<PlannedTile> parts;
  for (const PlannedTile& tile : tiles) {
    if (tile.level <= level) {
      parts.push_back(tile);
      continue;
    }
    for (std::uint64_t octant = 0; octant < 8; ++octant) {
      PlannedTile part = tile;
      part.level = tile.level - 1;
      part.code = tile.code + (octant << (3 * part.level));
      part.vertices = (tile.vertices + 7) / 8;
      part.polygons = (tile.polygons + 7) / 8;
      parts.push_back(part);
    }
  }
  return parts;
}

}  // namespace

std::vector<PlannedRange> cube_ranges(std::span<const PlannedTile> planned, std::size_t enough,
                                      int level) {
  std::vector<PlannedTile> tiles(planned.begin(), planned.end());
  while (!tiles.empty() && tiles.size() < enough) {
    std::vector<PlannedTile> parts = cut(tiles, static_cast<std::uint32_t>(level));
    if (parts.size() == tiles.size()) break;
    tiles = std::move(parts);
  }
  std::vector<PlannedRange> ranges;
  std::uint64_t cube = 0;  // of the tile before
  for (const PlannedTile& tile : tiles) {
    const std::uint64_t begin = tile.code >> (3 * level);
    if (ranges.empty()) {
      ranges.emplace_back();
    } else if (cube != begin) {
      ranges.back().cubes.end = begin;
      ranges.push_back({{begin, CubeRange{}.end}});
    }
    cube = begin;
    ranges.back().vertices += tile.vertices;
    ranges.back().polygons += tile.polygons;
  }
  return ranges;
}

}  // namespace voxweld
