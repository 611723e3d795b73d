#include "pipeline/output/level_cut.h"

#include <algorithm>
#include <tuple>

namespace voxweld {
namespace {

std::uint64_t end_of(const CellKey& cell) {
  return cell.code() + (std::uint64_t{1} << (3 * cell.level));
}

}  // namespace

LevelCut::LevelCut(std::span<const LevelTile> tiles, int top) {
  std::vector<Shown> all;
  for (const LevelTile& tile : tiles)
    if (tile.lod <= top) all.push_back({tile.cell.code(), end_of(tile.cell), tile.lod});
  std::ranges::sort(all, {},
                    [](const Shown& one) { return std::tuple(one.begin, ~one.end, -one.lod); });
  for (const Shown& one : all)
    if (shown_.empty() || one.begin >= shown_.back().end) shown_.push_back(one);
}

bool LevelCut::takes(const TileRecord& record) const {
  const CellKey cell = record.place.value_or(record.tile);
  const std::uint64_t begin = cell.code(), end = end_of(cell);
  const auto after = std::ranges::upper_bound(shown_, begin, {}, &Shown::begin);
  const bool within = after != shown_.begin() && end <= (after - 1)->end;
  if (record.lod == 0) return !within;
  return within && (after - 1)->lod == record.lod && (after - 1)->begin == begin &&
         (after - 1)->end == end;
}

std::vector<LevelTile> listed_levels(const std::filesystem::path& output) {
  std::vector<LevelTile> tiles;
  if (!std::filesystem::exists(output / levels_name)) return tiles;
  TileListReader reader(output / levels_name);
  while (const auto record = reader.next()) tiles.push_back({record->tile, record->lod});
  return tiles;
}

int top_of(std::span<const LevelTile> tiles) {
  int top = 0;
  for (const LevelTile& tile : tiles) top = std::max(top, tile.lod);
  return top;
}

}  // namespace voxweld
