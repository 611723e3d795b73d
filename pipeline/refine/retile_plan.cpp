#include "pipeline/refine/retile_plan.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <optional>

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

std::vector<PlanSource> sources_of(CubeMeshes& meshes) {
  std::vector<PlanSource> sources;
  for (const CubeMeshes::Entry& entry : meshes.entries())
    sources.push_back(
        {entry.content, entry.summary.pieces, entry.summary.lowest, entry.summary.highest});
  return sources;
}

// The counts of all meshes, label by label.
class SortedBlocks {
 public:
  explicit SortedBlocks(const RetileInputs& inputs)
      : job_(inputs.job), blocks_(job_.folder.parent_path(), sorter_bytes) {
    CubeMeshes& meshes = inputs.meshes;
    probe_in_order<Counts>(
        meshes.size(), meshes_ahead,
        [&](std::size_t i) {
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
  };
  // The largest cubes whose triangles make at most so many vertices. A closed surface has half as
  // many vertices as triangles; where a vertex lies does not matter then, so each unit of the last pass can
  // count by itself what it has.
  // label: above that of the call before.
  Surface plan(Material label) {
    Surface surface;
    TilePlanner planner(domain_level(job_.frame.size), job_.tile_vertices,
                        [&](const PlannedTile& tile) { surface.tiles.push_back(tile); });
    if (next_ && next_->key.label < label)
      throw std::logic_error(
          fmt::format("retile: label {} is refined and was not merged", next_->key.label));
    for (; next_ && next_->key.label == label; advance()) {
      surface.lost_vertices += next_->lost_vertices;
      if (next_->triangles == 0) continue;
      const std::uint64_t half = (next_->triangles + 1) / 2;
      planner.push({next_->key.code, tile_block_level, static_cast<std::uint32_t>(half), half});
    }
    planner.finish();
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
  ExternalSorter<BlockOrder> blocks_;
  std::optional<BlockOrder::Head> next_;
};

// Nothing where there is none, it is of other parameters, or damaged.
std::unique_ptr<TilePlanArtifact> plan_on_disk(const RetileJob& job, Hash128 key) {
  if (!std::filesystem::exists(job.plan_path())) return nullptr;
  try {
    auto artifact = std::make_unique<TilePlanArtifact>(job.plan_path());
    if (artifact->key() == key) return artifact;
  } catch (const DamagedArtifact& damage) {
    spdlog::debug("{}", damage.what());
  }
  return nullptr;
}

// One surface.
class SurfaceRetilePlan final : public RetilePlan {
 public:
  SurfaceRetilePlan(const RetileInputs& inputs, bool trust) : job_(inputs.job) {
    on_disk_ = take_from_disk(inputs, trust);
    if (!on_disk_) {
      tiles_ = SortedBlocks(inputs).plan(0).tiles;
      sources_ = sources_of(inputs.meshes);
    }
    units_ = unit_plan(tiles_);
  }

  const UnitPlan& units() const override { return *units_; }
  std::vector<RefinedTile> tiles(std::uint64_t unit) const override { return {{0, tiles_[unit]}}; }
  Hash128 content() const override {
    KeyHasher key;
    key.bytes(as_section(tiles_)).bytes(as_section(sources_));
    return key.finish();
  }
  void write() override {
    write_tile_plan(job_.plan_path(), job_.key, {tiles_, sources_});
    on_disk_ = true;
  }

 private:
  bool take_from_disk(const RetileInputs& inputs, bool trust) {
    const auto artifact = plan_on_disk(job_, job_.key);
    if (artifact == nullptr) return false;
    try {
      tiles_ = artifact->tiles();
      sources_ = artifact->sources();
    } catch (const DamagedArtifact& damage) {
      spdlog::debug("{}", damage.what());
      return false;
    }
    return sources_.size() == inputs.meshes.size() &&
           (trust || sources_ == sources_of(inputs.meshes));
  }

  const RetileJob& job_;
  std::vector<PlannedTile> tiles_;
  std::unique_ptr<UnitPlan> units_;
};

// Of labels: a file from the start, which is elsewhere until write(). So what it takes in memory is
// what merge's plan does.
class LabelRetilePlan final : public RetilePlan {
 public:
  LabelRetilePlan(const RetileInputs& inputs, bool trust)
      : job_(inputs.job),
        // The list of labels is merge's, and how many vertices each had.
        key_(KeyHasher().hash(job_.key).hash(inputs.top.content_hash()).finish()) {
    on_disk_ = take_from_disk(inputs, trust);
    if (on_disk_) return;
    scratch_ = temporary_name(job_.folder.parent_path() / job_.plan_path().filename());
    make(inputs);
    open(std::make_unique<TilePlanArtifact>(scratch_));
  }
  ~LabelRetilePlan() override {
    std::error_code error;
    if (!scratch_.empty()) std::filesystem::remove(scratch_, error);
  }
  LabelRetilePlan(const LabelRetilePlan&) = delete;
  LabelRetilePlan& operator=(const LabelRetilePlan&) = delete;

  const UnitPlan& units() const override { return *units_; }
  std::vector<RefinedTile> tiles(std::uint64_t unit) const override {
    const BatchRecord& batch = batches_[unit];
    const auto surfaces = tables_->surfaces(batch.first_surface, batch.surfaces);
    std::vector<RefinedTile> tiles;
    for (const PlannedTile& tile : tables_->tiles(batch.first_tile, batch.tiles))
      tiles.push_back({surfaces[tiles.size()].material, tile});
    return tiles;
  }
  Hash128 content() const override { return artifact_->content_hash(); }
  void write() override {
    make_directories(job_.folder);
    std::filesystem::rename(scratch_, job_.plan_path());
    scratch_.clear();
    open(std::make_unique<TilePlanArtifact>(job_.plan_path()));
    on_disk_ = true;
  }

 private:
  bool take_from_disk(const RetileInputs& inputs, bool trust) {
    auto artifact = plan_on_disk(job_, key_);
    if (artifact == nullptr) return false;
    try {
      open(std::move(artifact));
    } catch (const DamagedArtifact& damage) {
      spdlog::debug("{}", damage.what());
      return false;
    }
    return sources_.size() == inputs.meshes.size() &&
           (trust || sources_ == sources_of(inputs.meshes));
  }

  void make(const RetileInputs& inputs) const {
    SortedBlocks blocks(inputs);
    const MaterialTop merged(inputs.top);
    LabelTilePlanWriter out(scratch_, key_);
    BatchPlanner batches(out, job_.tile_vertices);
    for (std::uint64_t first = 0; first < merged.surface_count(); first += page_records) {
      const std::uint64_t count = std::min(page_records, merged.surface_count() - first);
      for (const SurfaceRecord& surface : merged.surfaces(first, count))
        add(surface, blocks.plan(surface.material), out, batches);
    }
    batches.finish();
    out.finish(sources_of(inputs.meshes));
  }

  // A label without triangles has a tile all the same, an empty one: it is listed as one whose
  // stitched mesh is empty is.
  void add(const SurfaceRecord& surface, SortedBlocks::Surface&& planned, LabelTilePlanWriter& out,
           BatchPlanner& batches) const {
    std::vector<PlannedTile>& tiles = planned.tiles;
    if (tiles.empty())
      tiles.push_back({0, static_cast<std::uint32_t>(domain_level(job_.frame.size)), 0, 0, 0});
    for (const PlannedTile& tile : tiles) out.tile(tile);
    out.end_surface(surface.material, surface.vertices - planned.lost_vertices);
    batches.add(surface.material, tiles, 0, [](KeyHasher&, const PlannedTile&) {});
  }

  void open(std::unique_ptr<TilePlanArtifact> artifact) {
    units_.reset();
    tables_.reset();
    artifact_ = std::move(artifact);
    sources_ = artifact_->sources();
    tables_.emplace(artifact_->file());
    batches_ = tables_->batches();
    units_ = unit_plan(*artifact_);
  }

  const RetileJob& job_;
  const Hash128 key_;
  std::filesystem::path scratch_;  // empty: it is where the job has it
  std::unique_ptr<TilePlanArtifact> artifact_;
  std::optional<MaterialTop> tables_;
  std::vector<BatchRecord> batches_;
  std::unique_ptr<UnitPlan> units_;
};

}  // namespace

std::unique_ptr<RetilePlan> retile_plan(const RetileInputs& inputs, bool trust) {
  if (inputs.labels == LabelMode::each) return std::make_unique<LabelRetilePlan>(inputs, trust);
  return std::make_unique<SurfaceRetilePlan>(inputs, trust);
}

}  // namespace voxweld
