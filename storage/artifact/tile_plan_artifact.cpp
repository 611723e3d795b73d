#include "storage/artifact/tile_plan_artifact.h"

namespace voxweld {
namespace {

constexpr std::uint64_t plan_sources_section = 2;
constexpr std::uint64_t first_middle_page = std::uint64_t{7} << 56;

static_assert(sizeof(PlanSource) == 16 + 8 + 2 * 16);

}  // namespace

TilePlanWriter::TilePlanWriter(const std::filesystem::path& path, Hash128 key)
    : MaterialTablesWriter(path, {tile_plan_kind, tile_plan_version, key}),
      middles_(file(), first_middle_page) {}

Hash128 TilePlanWriter::finish(std::span<const PlanSource> sources) {
  finish_pages();
  middles_.finish();
  file().section(plan_sources_section, std::as_bytes(sources));
  return finish_tables();
}

TilePlanArtifact::TilePlanArtifact(const std::filesystem::path& path)
    : OpenArtifact(path, tile_plan_kind, tile_plan_version) {}

std::vector<std::uint64_t> TilePlanArtifact::middles(std::uint64_t first,
                                                     std::uint64_t count) const {
  return PagedTable<std::uint64_t>(file_, first_middle_page, MaterialTop(file_).surface_count())
      .read(first, count);
}

std::vector<PlanSource> TilePlanArtifact::sources() const {
  return file_.read_array<PlanSource>(plan_sources_section);
}

}  // namespace voxweld
