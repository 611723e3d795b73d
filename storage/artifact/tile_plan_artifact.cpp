#include "storage/artifact/tile_plan_artifact.h"

namespace voxweld {
namespace {

constexpr std::uint64_t plan_sources_section = 2;

static_assert(sizeof(PlanSource) == 16 + 8 + 2 * 16);

}  // namespace

Hash128 TilePlanWriter::finish(std::span<const PlanSource> sources) {
  finish_pages();
  file().section(plan_sources_section, std::as_bytes(sources));
  return finish_tables();
}

TilePlanArtifact::TilePlanArtifact(const std::filesystem::path& path)
    : OpenArtifact(path, tile_plan_kind, tile_plan_version) {}

std::vector<PlanSource> TilePlanArtifact::sources() const {
  return file_.read_array<PlanSource>(plan_sources_section);
}

}  // namespace voxweld
