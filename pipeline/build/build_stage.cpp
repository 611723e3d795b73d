#include "pipeline/build/build_stage.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <mutex>

#include "pipeline/build/common_material.h"
#include "pipeline/build/finer_build.h"
#include "pipeline/build/shard_builders.h"
#include "pipeline/executor/memory_budget.h"
#include "pipeline/executor/probe.h"
#include "stages/solids/lattice_solid.h"
#include "storage/support/error.h"

namespace voxweld {
namespace {

Hash128 volume_stamp(const BuildJob& job, Index3 shard) {
  return job.volume.stamp(shard_samples(job, shard));
}

enum class ArtifactState { missing, unproven, current, out_of_reach };

bool input_is_there(const BuildJob& job, Index3 shard) {
  try {
    volume_stamp(job, shard);
    return true;
  } catch (const DamagedArtifact&) {
    return false;
  }
}

ArtifactState state_of(const BuildJob& job, Index3 shard) {
  if (job.partial_input && !input_is_there(job, shard)) return ArtifactState::out_of_reach;
  const auto path = shard_artifact_path(job, shard);
  if (!std::filesystem::exists(path)) return ArtifactState::missing;
  try {
    const ArtifactReader artifact = open_octrees(job, shard);
    if (artifact.key() != shard_key(job, shard)) return ArtifactState::missing;
    return artifact.input_stamp() == volume_stamp(job, shard) ? ArtifactState::current
                                                              : ArtifactState::unproven;
  } catch (const DamagedArtifact& damage) {
    if (damage.path() != path.string()) throw;
    return ArtifactState::missing;
  }
}

// Of a brick that is skipped, against one with a surface.
constexpr double cost_of_empty_brick = 0.01;

// As shard_units; bricks count in full where the volume's ranges leave room for a surface. The
// ranges of one brick's own samples do for that: one record is read for a shard.
std::vector<Unit> weighed_units(const BuildJob& job, std::span<const std::uint64_t> numbers) {
  std::vector<Unit> units = shard_units(job.grid, numbers);
  if (job.volume.ranges() == nullptr) return units;
  const std::vector<Index3> shards = job.grid.all_shards();
  const std::int64_t side = std::int64_t{1} << job.grid.brick_level();
  const Isovalue isovalue = job.parameters.surface.isovalue;
  const LabelParameters& labels = job.parameters.labels;
  const auto has_surface = [&](const ValueRange& range) {
    if (range.empty) return false;
    if (labels.mode != LabelMode::off) return !common_material(*labels.rules, range).has_value();
    return range.lo <= isovalue && range.hi >= isovalue;
  };
  probe_all(units.size(), [&](std::size_t i) {
    const Box3 bricks = job.grid.shard_bricks(shards[units[i].key]);
    double& weight = units[i].weight;
    weight *= cost_of_empty_brick;
    for (std::int64_t z = bricks.lo.z; z < bricks.hi.z; ++z)
      for (std::int64_t y = bricks.lo.y; y < bricks.hi.y; ++y)
        for (std::int64_t x = bricks.lo.x; x < bricks.hi.x; ++x) {
          const Index3 lo = Index3{x, y, z} * side;
          const Box3 samples = intersect({lo, lo + splat(side)}, Box3{{}, job.grid.size()});
          if (samples.empty()) continue;
          if (has_surface(job.volume.ranges()->range(samples))) weight += 1;
        }
  });
  return units;
}

// Whether the samples are those the artifact was made from; then it says so from now on.
bool proven(const BuildJob& job, Index3 shard, ShardBuilder& builder) {
  const auto path = shard_artifact_path(job, shard);
  const Hash128 stamp = volume_stamp(job, shard);
  const ShardSummary made = read_summary(open_octrees(job, shard));
  Hash128 input = builder.input_hash(shard, true);
  // Where ranges left bricks out, that was to find them anew.
  if (made.unread > 0) input = builder.input_hash(shard, false);
  if (input != made.input) return false;
  restamp_artifact(path, stamp);
  return true;
}

// What of the volume the config's edits have a say in; they are the last of all, behind the mesh
// that may be the input.
void report_edits(const BuildJob& job, std::size_t count) {
  if (count == 0) return;
  const auto edits = std::span(job.parameters.edits).last(count);
  const std::vector<Index3> shards = job.grid.all_shards();
  const auto reached = probe_which(shards.size(), [&](std::size_t i) {
    const Bounds bounds = shard_bounds(job, shards[i]);
    return std::ranges::any_of(edits, [&](const Edit& e) { return edit_reaches(e, bounds); });
  });
  spdlog::info("{} {} in {} of {} shards", edits.size(),
               edits.size() == 1 ? "edit has a say" : "edits have a say", reached.size(),
               shards.size());
}

class BuildWork final : public StageWork {
 public:
  explicit BuildWork(const BuildJob& job) : job_(job), shards_(job.grid.all_shards()) {}

  Stage stage() const override { return Stage::build; }
  std::string noun() const override { return "shards"; }
  std::string identity() const override { return job_.folder.filename().string(); }
  std::uint64_t size() const override { return shards_.size(); }
  std::vector<Unit> units(std::span<const std::uint64_t> numbers) const override {
    return weighed_units(job_, numbers);
  }
  bool done(std::uint64_t unit) override {
    return state_of(job_, shards_[unit]) == ArtifactState::current;
  }
  StageLook look(const UnitSelection& selection) override;
  void prove(RunContext& context, StageLook& look) override;

  StageMemory memory(std::span<const std::uint64_t>) override;
  void open(RunContext& context, const StageLook&) override {
    if (context.selection.all()) report_edits(job_, context.config.edits.size());
  }
  void begin(RunContext& context, std::span<const std::uint64_t>, int threads) override {
    if (collapses_by_sheets(job_.parameters))
      note_tolerance(job_.folder, context.config.simplify.tolerance);
    builders_.emplace(job_, threads);
  }
  void run(const Unit& unit, WorkerContext& worker) override {
    builders_->borrow()->build(shards_[unit.key], worker);
  }
  void end(RunContext& context) override {
    for (const auto& builder : builders_->all()) {
      context.bricks += builder->bricks();
      context.nans.add(builder->nans());
    }
    builders_.reset();
    if (context.bricks.unread > 0)
      spdlog::info(
          "of these shards' bricks {} have no surface, as an earlier build found: not read",
          context.bricks.unread);
    if (context.bricks.kept > 0)
      spdlog::info("of these shards' bricks {} were built and {} kept: no edit of theirs changed",
                   context.bricks.built, context.bricks.kept);
    if (context.bricks.cut > 0 && !context.extraction)
      spdlog::info(
          "of these shards' bricks {} were built, and {} cut from what a smaller "
          "simplify.tolerance left: {} read in place of samples",
          context.bricks.built, context.bricks.cut,
          readable_bytes(static_cast<double>(context.bricks.bytes_cut)));
  }

 private:
  const BuildJob& job_;
  const std::vector<Index3> shards_;
  std::optional<ShardBuilders> builders_;  // while units run
};

StageLook BuildWork::look(const UnitSelection& selection) {
  StageLook look;
  look.units = size();
  std::vector<ArtifactState> states(shards_.size(), ArtifactState::current);
  probe_all(shards_.size(), [&](std::size_t i) {
    if (selection.contains(i)) states[i] = state_of(job_, shards_[i]);
  });
  for (std::size_t i = 0; i < states.size(); ++i) {
    if (states[i] == ArtifactState::missing) look.missing.push_back(i);
    if (states[i] == ArtifactState::unproven) look.unproven.push_back(i);
  }
  return look;
}

// Reads the samples of the unproven again and compares their content hash with what the artifacts
// were made from: those that are the same get the volume's stamp, the others become missing.
void BuildWork::prove(RunContext& context, StageLook& look) {
  if (look.unproven.empty()) return;
  StageRun stage;
  stage.stage = "check";
  stage.noun = "shards";
  stage.memory = memory(look.unproven);
  const int threads = stage_threads(context, stage.memory);
  begin(context, look.unproven, threads);
  std::mutex mutex;
  run_stage(context, stage, shard_units(job_.grid, look.unproven), threads,
            [&](const Unit& unit, WorkerContext&) {
              if (proven(job_, shards_[unit.key], *builders_->borrow())) return;
              const std::scoped_lock lock(mutex);
              look.missing.push_back(unit.key);
            });
  builders_.reset();
  std::sort(look.missing.begin(), look.missing.end());
  look.unproven.clear();
}

StageMemory BuildWork::memory(std::span<const std::uint64_t>) {
  StageMemory memory = build_memory(job_.grid, job_.memory);
  memory.base_bytes = job_.largest_bin.index_bytes;
  memory.per_worker_bytes += job_.largest_bin.bytes;
  if (job_.largest_bin.triangles > 0)
    memory.unit += fmt::format(" with up to {} triangles of the mesh", job_.largest_bin.triangles);
  return memory;
}

}  // namespace

std::vector<Unit> shard_units(const BrickGrid& grid, std::span<const std::uint64_t> numbers) {
  const std::vector<Index3> shards = grid.all_shards();
  std::vector<Unit> units;
  for (const std::uint64_t number : numbers) {
    const Index3 shard = shards[number];
    units.push_back({number, fmt::format("shard {}/{}/{}", shard.x, shard.y, shard.z),
                     static_cast<double>(grid.shard_bricks(shard).count())});
  }
  return units;
}

StageMemory build_memory(const BrickGrid& grid, const ShardMemory& shard) {
  return {"build",
          0,
          shard.brick,
          fmt::format("one brick (work.brick = {})", std::int64_t{1} << grid.brick_level()),
          grid.brick_level() > min_brick_level ? "raise run.memory or lower work.brick"
                                               : "raise run.memory",
          shard.worker};
}

std::unique_ptr<StageWork> build_stage(const BuildJob& job) {
  return std::make_unique<BuildWork>(job);
}

}  // namespace voxweld
