#include "storage/artifact/tile_plan_artifact.h"

namespace voxweld {
namespace {

constexpr std::uint64_t planned_tiles_section = 1, plan_sources_section = 2;

static_assert(sizeof(PlanSource) == 16 + 8 + 2 * 16);

}  // namespace

void write_tile_plan(const std::filesystem::path& path, Hash128 key, const TilePlanParts& parts) {
  ArtifactWriter file(path, {tile_plan_kind, tile_plan_version, key});
  file.section(planned_tiles_section, as_section(parts.tiles));
  file.section(plan_sources_section, as_section(parts.sources));
  file.commit();
}

Hash128 LabelTilePlanWriter::finish(std::span<const PlanSource> sources) {
  finish_pages();
  file().section(plan_sources_section, std::as_bytes(sources));
  return finish_tables();
}

TilePlanArtifact::TilePlanArtifact(const std::filesystem::path& path)
    : OpenArtifact(path, tile_plan_kind, tile_plan_version) {}

bool TilePlanArtifact::of_labels() const {
  return file_.find(planned_tiles_section) == nullptr;
}

std::vector<PlannedTile> TilePlanArtifact::tiles() const {
  auto tiles = file_.read_array<PlannedTile>(planned_tiles_section);
  for (const PlannedTile& tile : tiles)
    if (tile.level > max_levels) file_.damaged("a tile is larger than any domain");
  return tiles;
}

std::vector<PlanSource> TilePlanArtifact::sources() const {
  return file_.read_array<PlanSource>(plan_sources_section);
}

}  // namespace voxweld
