#include "pipeline/build/build_stage.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <mutex>

#include "pipeline/build/common_material.h"
#include "pipeline/build/shard_builder.h"
#include "pipeline/executor/probe.h"
#include "pipeline/stage/shard_memory.h"
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

StageMemory build_memory(const RunContext& context, const BuildJob& job) {
  const Edits& edits = job.parameters.edits;
  const bool replaces = std::any_of(edits.begin(), edits.end(),
                                    [](const Edit& edit) { return edit.op == EditOp::replace; });
  std::string unit = fmt::format("one brick (work.brick = {})", context.config.work.brick);
  if (job.largest_bin.triangles > 0)
    unit += fmt::format(" with up to {} triangles of the mesh", job.largest_bin.triangles);
  return {"build", job.largest_bin.index_bytes,
          job.largest_bin.bytes + shard_memory_bytes(job.grid, job.volume.source->info().type,
                                                     job.parameters.labels.mode, replaces),
          unit, "raise run.memory or lower work.brick"};
}

// Of a brick that is skipped, against one with a surface.
constexpr double cost_of_empty_brick = 0.01;

// As shard_units; bricks count in full where the volume's ranges leave room for a surface. The
// ranges of one brick's own samples do for that: one record is read for a shard.
std::vector<Unit> weighed_units(const BuildJob& job, const std::vector<std::uint64_t>& numbers) {
  std::vector<Unit> units = shard_units(job.grid, numbers);
  if (job.volume.ranges() == nullptr) return units;
  const std::vector<Index3> shards = job.grid.all_shards();
  const std::int64_t side = std::int64_t{1} << job.grid.brick_level();
  const double isovalue = job.parameters.surface.isovalue;
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

// One for each worker slot.
std::vector<std::unique_ptr<ShardBuilder>> make_builders(const BuildJob& job, int threads) {
  std::vector<std::unique_ptr<ShardBuilder>> builders;
  builders.reserve(static_cast<std::size_t>(threads));
  for (int i = 0; i < threads; ++i) builders.push_back(std::make_unique<ShardBuilder>(job));
  return builders;
}

// Whether the samples are those the artifact was made from; then it says so from now on.
bool proven(const BuildJob& job, Index3 shard, ShardBuilder& builder) {
  const auto path = shard_artifact_path(job, shard);
  const Hash128 stamp = volume_stamp(job, shard);
  if (builder.input_hash(shard) != read_summary(open_octrees(job, shard)).input) return false;
  restamp_artifact(path, stamp);
  return true;
}

}  // namespace

std::vector<Unit> shard_units(const BrickGrid& grid, const std::vector<std::uint64_t>& numbers) {
  const std::vector<Index3> shards = grid.all_shards();
  std::vector<Unit> units;
  for (const std::uint64_t number : numbers) {
    const Index3 shard = shards[number];
    units.push_back({number, fmt::format("shard {}/{}/{}", shard.x, shard.y, shard.z),
                     static_cast<double>(grid.shard_bricks(shard).count())});
  }
  return units;
}

BuildStatus build_status(const RunContext& context, const BuildJob& job) {
  BuildStatus status;
  const std::vector<Index3> shards = job.grid.all_shards();
  context.selection.check("build", "shards", shards.size());
  std::vector<ArtifactState> states(shards.size(), ArtifactState::current);
  probe_all(shards.size(), [&](std::size_t i) {
    if (context.selection.contains(i)) states[i] = state_of(job, shards[i]);
  });
  for (std::size_t i = 0; i < shards.size(); ++i) {
    if (states[i] == ArtifactState::missing) status.missing.push_back(i);
    if (states[i] == ArtifactState::unproven) status.unproven.push_back(i);
  }
  return status;
}

void prove(RunContext& context, const BuildJob& job, BuildStatus& status) {
  if (status.unproven.empty()) return;
  StageRun stage;
  stage.stage = "check";
  stage.noun = "shards";
  stage.memory = build_memory(context, job);
  const int threads = stage_threads(context, stage.memory);
  const auto builders = make_builders(job, threads);
  const std::vector<Index3> shards = job.grid.all_shards();
  std::mutex mutex;
  run_stage(context, stage, shard_units(job.grid, status.unproven), threads,
            [&](const Unit& unit, WorkerContext& worker) {
              ShardBuilder& builder = *builders[static_cast<std::size_t>(worker.slot())];
              if (proven(job, shards[unit.key], builder)) return;
              const std::scoped_lock lock(mutex);
              status.missing.push_back(unit.key);
            });
  std::sort(status.missing.begin(), status.missing.end());
  status.unproven.clear();
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

void run_build(RunContext& context, const BuildJob& job) {
  if (context.selection.all()) report_edits(job, context.config.edits.size());
  BuildStatus status = build_status(context, job);
  if (context.executor->in_process()) prove(context, job, status);

  // Elsewhere the one that builds a shard first looks whether it has to.
  std::vector<std::uint64_t> numbers = status.missing;
  numbers.insert(numbers.end(), status.unproven.begin(), status.unproven.end());
  std::sort(numbers.begin(), numbers.end());
  StageRun stage;
  stage.stage = "build";
  stage.noun = "shards";
  const std::vector<Index3> shards = job.grid.all_shards();
  stage.reused = context.selection.count(shards.size()) - numbers.size();
  stage.memory = build_memory(context, job);
  const int threads = stage_threads(context, stage.memory);
  const auto builders = make_builders(job, threads);
  stage.identity = job.folder.filename().string();
  stage.done = [&](const Unit& unit) {
    return state_of(job, shards[unit.key]) == ArtifactState::current;
  };
  run_stage(context, stage, weighed_units(job, numbers), threads,
            [&](const Unit& unit, WorkerContext& worker) {
              ShardBuilder& builder = *builders[static_cast<std::size_t>(worker.slot())];
              builder.build(shards[unit.key], worker);
            });
  for (const auto& builder : builders) context.bricks += builder->bricks();
  if (context.bricks.kept > 0)
    spdlog::info("of these shards' bricks {} were built and {} kept: no edit of theirs changed",
                 context.bricks.built, context.bricks.kept);
}

}  // namespace voxweld
