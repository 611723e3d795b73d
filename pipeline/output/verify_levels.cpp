#include "pipeline/output/verify_levels.h"

#include <fmt/format.h>

#include <algorithm>
#include <tuple>

#include "pipeline/output/tile_stream.h"

namespace voxweld {
namespace {

std::uint64_t end_of(const CellKey& cell) {
  return cell.code() + (std::uint64_t{1} << (3 * cell.level));
}

std::vector<LevelTile> listed_tiles(const std::filesystem::path& list) {
  std::vector<LevelTile> tiles;
  TileListReader reader(list);
  while (const auto record = reader.next()) tiles.push_back({record->tile, record->lod});
  return tiles;
}

}  // namespace

LevelCut::LevelCut(std::span<const LevelTile> tiles, int top) {
  std::vector<Shown> all;
  for (const LevelTile& tile : tiles)
    if (tile.lod <= top) all.push_back({tile.cell.code(), end_of(tile.cell), tile.lod});
  std::ranges::sort(all, {}, [](const Shown& one) {
    return std::tuple(one.begin, ~one.end, -one.lod);
  });
  for (const Shown& one : all)
    if (shown_.empty() || one.begin >= shown_.back().end) shown_.push_back(one);
}

bool LevelCut::takes(const TileRecord& record) const {
  const std::uint64_t code = record.tile.code();
  const auto after = std::ranges::upper_bound(shown_, code, {}, &Shown::begin);
  const bool within = after != shown_.begin() && code < (after - 1)->end;
  if (record.lod == 0) return !within;
  return within && (after - 1)->lod == record.lod && (after - 1)->begin == code &&
         (after - 1)->end == end_of(record.tile);
}

LevelTotals verify_levels(const LevelVerifier& verifier) {
  const std::filesystem::path list = verifier.directory / levels_name;
  const std::vector<LevelTile> tiles = listed_tiles(list);
  LevelTotals totals;
  int top = 0;
  for (const LevelTile& tile : tiles) top = std::max(top, tile.lod);
  for (int level = 1; level <= top; ++level) {
    const LevelCut cut(tiles, level);
    SeamCheck seams(verifier.frame, verifier.rules);
    const auto named = [&](Problem problem) {
      problem.where = fmt::format("at level {}: {}", level, problem.where);
      verifier.report(std::move(problem));
    };
    for (const char* name : {levels_name, tiles_name})
      for_each_taken<TileResult>(
          verifier.directory / name, verifier.threads,
          [&](const TileRecord& record) { return cut.takes(record); },
          [&](TileRecord record, std::size_t) {
            verifier.between();
            return verifier.tiles.check(std::move(record), {});
          },
          [&](const TileResult& result) {
            seams.add(result.record.tile, result.seams);
            if (result.record.lod != level) return;  // looked at before
            for (const Problem& problem : result.problems) named(problem);
            ++totals.tiles;
            totals.files += result.files;
            totals.bytes += result.bytes;
          });
    seams.finish(named);
  }
  totals.levels = static_cast<std::uint64_t>(top);
  return totals;
}

}  // namespace voxweld
