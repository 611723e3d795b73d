#include "pipeline/output/verify_levels.h"

#include <fmt/format.h>

#include "pipeline/output/level_cut.h"
#include "pipeline/output/tile_stream.h"

namespace voxweld {

LevelTotals verify_levels(const LevelVerifier& verifier) {
  const std::vector<LevelTile> tiles = listed_levels(verifier.directory);
  const int top = top_of(tiles);
  LevelTotals totals;
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
            return verifier.tiles.check(std::move(record), {.by_label = verifier.each_label});
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
