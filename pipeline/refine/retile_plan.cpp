#include "pipeline/refine/retile_plan.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <utility>

#include "pipeline/executor/probe.h"
#include "pipeline/stage/batch_planner.h"
#include "stages/merge/tile_planner.h"
#include "stages/refine/retile.h"
#include "storage/support/error.h"
#include "storage/support/external_sorter.h"
#include "storage/support/file_io.h"

namespace voxweld {
namespace {

constexpr std::uint64_t sorter_bytes = std::uint64_t{32} << 20;
constexpr std::size_t meshes_ahead = 64;

// A block may have triangles in several artifacts, and a label may lose vertices in several: those
// stand at its first code. What mend has changed of a block may make the sum zero.
struct BlockOrder {
  struct Head {
    CubeKey key;
    std::uint64_t triangles = 0, lost_vertices = 0;
  };
  static bool less(const Head& a, const Head& b) { return a.key < b.key; }
  static bool join(Head& into, const Head& next) {
    into.triangles += next.triangles;
    into.lost_vertices += next.lost_vertices;
    return true;
  }
};

// Around some cells.
class CellBox {
 public:
  void extend(Index3 cell) {
    for (int axis = 0; axis < 3; ++axis) {
      lo_[axis] = any_ ? std::min(lo_[axis], cell[axis]) : cell[axis];
      hi_[axis] = any_ ? std::max(hi_[axis], cell[axis]) : cell[axis];
    }
    any_ = true;
  }
  // Morton code; 0 of none.
  std::uint64_t middle() const {
    return morton_encode({(lo_.x + hi_.x) / 2, (lo_.y + hi_.y) / 2, (lo_.z + hi_.z) / 2});
  }

 private:
  bool any_ = false;
  Index3 lo_, hi_;
};

std::vector<PlanSource> sources_of(CubeMeshes& meshes) {
  std::vector<PlanSource> sources;
  for (const CubeMeshes::Entry& entry : meshes.entries())
    sources.push_back(
        {entry.content, entry.summary.pieces, entry.summary.lowest, entry.summary.highest});
  return sources;
}

// The counts of all meshes, one material after the other.
class SortedBlocks {
 public:
  explicit SortedBlocks(const RetileInputs& inputs)
      : job_(inputs.job), labels_(inputs.labels), blocks_(job_.folder.parent_path(), sorter_bytes) {
    CubeMeshes& meshes = inputs.meshes;
    const auto& entries = meshes.entries();
    probe_in_order<Counts>(
        meshes.size(), meshes_ahead,
        [&](std::size_t i) {
          if (!entries[i].counts) return Counts{};
          const auto mesh = meshes.open(i);
          return Counts{mesh->blocks(), mesh->changes()};
        },
        [&](std::size_t, Counts&& counts) {
          for (const BlockRecord& block : counts.blocks)
            blocks_.push({{block.label, block.code}, block.triangles, 0});
          for (const LabelChange& change : counts.changes)
            blocks_.push({{change.label, 0}, 0, change.lost_vertices});
        });
    advance();
  }

  struct Surface {
    std::vector<PlannedTile> tiles;
    std::uint64_t lost_vertices = 0;
    std::uint64_t middle = 0;  // of the box of its blocks, the code of a finest cell
  };
  // The largest cubes whose triangles make at most so many vertices. A closed surface has half as
  // many vertices as triangles; where a vertex lies does not matter then, so each unit of the last pass can
  // count by itself what it has.
  // label: above that of the call before.
  Surface plan(Material label) {
    Surface surface;
    CellBox box;
    TilePlanner planner(domain_level(job_.frame.size), job_.tile_vertices,
                        [&](const PlannedTile& tile) { surface.tiles.push_back(tile); });
    if (next_ && next_->key.label < label)
      throw std::logic_error(
          fmt::format("retile: label {} is refined and was not merged", next_->key.label));
    for (; next_ && next_->key.label == label; advance()) {
      surface.lost_vertices += next_->lost_vertices;
      if (next_->triangles == 0) continue;
      box.extend(morton_decode(next_->key.code));
      const std::uint64_t half = (next_->triangles + 1) / 2;
      planner.push({next_->key.code, tile_block_level, static_cast<std::uint32_t>(half), half});
    }
    planner.finish();
    surface.middle = box.middle();
    // A label without triangles has a tile all the same, an empty one: it is listed as one whose
    // stitched mesh is empty is.
    if (surface.tiles.empty() && labels_ == LabelMode::each)
      surface.tiles.push_back(
          {0, static_cast<std::uint32_t>(domain_level(job_.frame.size)), 0, 0, 0});
    return surface;
  }

 private:
  struct Counts {
    std::vector<BlockRecord> blocks;
    std::vector<LabelChange> changes;
  };
  void advance() {
    next_.emplace();
    if (!blocks_.next(*next_)) next_.reset();
  }

  const RetileJob& job_;
  const LabelMode labels_;
  ExternalSorter<BlockOrder> blocks_;
  std::optional<BlockOrder::Head> next_;
};

}  // namespace

RetilePlan::RetilePlan(const RetileInputs& inputs, bool trust)
    : job_(inputs.job),
      // The list of materials is merge's, and how many vertices each had.
      key_(KeyHasher().hash(job_.key).hash(inputs.top.content_hash()).finish()),
      labels_(inputs.labels) {
  if (take_from_disk(inputs, trust)) return;
  scratch_ = temporary_name(job_.folder.parent_path() / job_.plan_path().filename());
  make(inputs);
  open(std::make_unique<TilePlanArtifact>(scratch_));
}

RetilePlan::~RetilePlan() {
  std::error_code error;
  if (!scratch_.empty()) std::filesystem::remove(scratch_, error);
}

void RetilePlan::write() {
  make_directories(job_.folder);
  std::filesystem::rename(scratch_, job_.plan_path());
  scratch_.clear();
  open(std::make_unique<TilePlanArtifact>(job_.plan_path()));
}

// False where there is none, it is of others, or damaged.
bool RetilePlan::take_from_disk(const RetileInputs& inputs, bool trust) {
  if (!std::filesystem::exists(job_.plan_path())) return false;
  try {
    auto artifact = std::make_unique<TilePlanArtifact>(job_.plan_path());
    if (artifact->key() != key_) return false;
    open(std::move(artifact));
  } catch (const DamagedArtifact& damage) {
    spdlog::debug("{}", damage.what());
    return false;
  }
  return sources_.size() == inputs.meshes.size() &&
         (trust || sources_ == sources_of(inputs.meshes));
}

void RetilePlan::make(const RetileInputs& inputs) const {
  SortedBlocks blocks(inputs);
  const MaterialTop merged(inputs.top);
  TilePlanWriter out(scratch_, key_);
  BatchPlanner batches(out, job_.tile_vertices);
  for (std::uint64_t first = 0; first < merged.surface_count(); first += page_records) {
    const std::uint64_t count = std::min(page_records, merged.surface_count() - first);
    for (const SurfaceRecord& surface : merged.surfaces(first, count)) {
      const SortedBlocks::Surface planned = blocks.plan(surface.material);
      for (const PlannedTile& tile : planned.tiles) out.tile(tile);
      out.middle(planned.middle);
      out.end_surface(surface.material, surface.vertices - planned.lost_vertices);
      batches.add(surface.material, planned.tiles, 0, [](KeyHasher&, const PlannedTile&) {});
    }
  }
  batches.finish();
  out.finish(sources_of(inputs.meshes));
}

std::vector<LevelLeaf> RetilePlan::level_leaves() const {
  const MaterialTop tables(artifact_->file());
  std::vector<LevelLeaf> leaves;
  leaves.reserve(tables.tile_count());
  for (std::uint64_t first = 0; first < tables.surface_count(); first += page_records) {
    const std::uint64_t count = std::min(page_records, tables.surface_count() - first);
    const std::vector<std::uint64_t> middles = artifact_->middles(first, count);
    const auto surfaces = tables.surfaces(first, count);
    for (std::size_t i = 0; i < surfaces.size(); ++i) {
      const SurfaceRecord& surface = surfaces[i];
      const bool whole = labels_ == LabelMode::each && surface.tiles == 1;
      const CellKey middle = CellKey::of(middles[i], static_cast<std::uint64_t>(job_.frame.level));
      for (const PlannedTile& tile : tables.tiles(surface.first_tile, surface.tiles))
        leaves.push_back({whole ? middle : tile.key(), tile.vertices, surface.material, whole});
    }
  }
  return leaves;
}

void RetilePlan::open(std::unique_ptr<TilePlanArtifact> artifact) {
  units_.reset();
  artifact_ = std::move(artifact);
  sources_ = artifact_->sources();
  units_.emplace(artifact_->file(), labels_, true);
}

}  // namespace voxweld
