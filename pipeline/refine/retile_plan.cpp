#include "pipeline/refine/retile_plan.h"

#include <spdlog/spdlog.h>

#include <optional>

#include "pipeline/executor/probe.h"
#include "stages/merge/tile_planner.h"
#include "stages/refine/retile.h"
#include "storage/support/error.h"
#include "storage/support/external_sorter.h"

namespace voxweld {
namespace {

constexpr std::uint64_t sorter_bytes = std::uint64_t{32} << 20;
constexpr std::size_t meshes_ahead = 64;

// A block may have triangles in several artifacts.
struct BlockOrder {
  struct Head {
    std::uint64_t code = 0, triangles = 0;
  };
  static bool less(const Head& a, const Head& b) { return a.code < b.code; }
  static bool join(Head& into, const Head& next) {
    into.triangles += next.triangles;
    return true;
  }
};

std::vector<PlanSource> sources_of(CubeMeshes& meshes) {
  std::vector<PlanSource> sources;
  for (const CubeMeshes::Entry& entry : meshes.entries())
    sources.push_back({entry.content, entry.summary.pieces, entry.summary.lowest_code,
                       entry.summary.highest_code});
  return sources;
}

// The largest cubes whose triangles make at most so many vertices. A closed surface has half as many
// vertices as triangles; where a vertex lies does not matter then, so each unit of seams can count
// by itself what it has.
std::vector<PlannedTile> plan_tiles(const RetileJob& job, CubeMeshes& meshes) {
  ExternalSorter<BlockOrder> blocks(job.folder.parent_path(), sorter_bytes);
  probe_in_order<std::vector<CubeCount>>(
      meshes.size(), meshes_ahead, [&](std::size_t i) { return meshes.open(i)->blocks(); },
      [&](std::size_t, std::vector<CubeCount>&& counts) {
        for (const CubeCount& block : counts) blocks.push({block.code, block.polygons});
      });
  std::vector<PlannedTile> tiles;
  TilePlanner planner(domain_level(job.frame.size), job.tile_vertices,
                      [&](const PlannedTile& tile) { tiles.push_back(tile); });
  for (BlockOrder::Head block; blocks.next(block);) {
    const std::uint64_t half = (block.triangles + 1) / 2;
    planner.push({block.code, tile_block_level, static_cast<std::uint32_t>(half), half});
  }
  planner.finish();
  return tiles;
}

// Nothing where there is none, or it is damaged.
std::optional<TilePlanParts> plan_on_disk(const RetileJob& job) {
  if (!std::filesystem::exists(job.plan_path())) return std::nullopt;
  try {
    const TilePlanArtifact artifact(job.plan_path());
    if (artifact.key() == job.key) return artifact.read();
  } catch (const DamagedArtifact& damage) {
    spdlog::debug("{}", damage.what());
  }
  return std::nullopt;
}

}  // namespace

RetilePlan::RetilePlan(const RetileJob& job, CubeMeshes& meshes, bool trust) : job_(job) {
  std::optional<TilePlanParts> there = plan_on_disk(job);
  on_disk_ = there && there->sources.size() == meshes.size() &&
             (trust || there->sources == sources_of(meshes));
  parts_ =
      on_disk_ ? std::move(*there) : TilePlanParts{plan_tiles(job, meshes), sources_of(meshes)};
  units_ = unit_plan(parts_.tiles);
}

Hash128 RetilePlan::content() const {
  KeyHasher key;
  key.bytes(as_section(parts_.tiles)).bytes(as_section(parts_.sources));
  return key.finish();
}

void RetilePlan::write() {
  write_tile_plan(job_.plan_path(), job_.key, parts_);
  on_disk_ = true;
}

}  // namespace voxweld
