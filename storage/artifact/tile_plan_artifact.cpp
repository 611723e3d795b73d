#include "storage/artifact/tile_plan_artifact.h"

namespace voxweld {
namespace {

constexpr std::uint64_t planned_tiles_section = 1, plan_sources_section = 2;

}  // namespace

void write_tile_plan(const std::filesystem::path& path, Hash128 key, const TilePlanParts& parts) {
  ArtifactWriter file(path, {tile_plan_kind, tile_plan_version, key});
  file.section(planned_tiles_section, as_section(parts.tiles));
  file.section(plan_sources_section, as_section(parts.sources));
  file.commit();
}

TilePlanParts TilePlanArtifact::read() const {
  TilePlanParts parts{file_.read_array<PlannedTile>(planned_tiles_section),
                      file_.read_array<PlanSource>(plan_sources_section)};
  for (const PlannedTile& tile : parts.tiles)
    if (tile.level > max_levels) file_.damaged("a tile is larger than any domain");
  return parts;
}

}  // namespace voxweld
