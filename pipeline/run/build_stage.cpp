#include "pipeline/run/build_stage.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <mutex>

#include "pipeline/run/shard_builder.h"
#include "pipeline/run/stamp.h"
#include "storage/support/error.h"

namespace voxweld {
namespace {

// The artifact's recorded input hash, or nothing when it is missing, damaged or of another key.
std::optional<Hash128> recorded_input(const BuildJob& job, Index3 shard) {
  const auto path = shard_artifact_path(job, shard);
  if (!std::filesystem::exists(path)) return std::nullopt;
  try {
    const ShardArtifact artifact(path);
    if (artifact.key() != job.key) return std::nullopt;
    return artifact.summary().input;
  } catch (const DamagedArtifact&) {
    return std::nullopt;
  }
}

StageMemory build_memory(const RunContext& context, const BuildJob& job) {
  return {"build", 0, ShardBuilder::memory_bytes(job.grid, job.volume.source->info().type),
          fmt::format("one brick (work.brick = {})", context.config.work.brick),
          "raise run.memory or lower work.brick"};
}

Unit unit_of(const BuildJob& job, Index3 shard) {
  return {morton_encode(shard), fmt::format("shard {}/{}/{}", shard.x, shard.y, shard.z),
          static_cast<double>(job.grid.shard_bricks(shard).count())};
}

// One for each worker slot.
std::vector<std::unique_ptr<ShardBuilder>> make_builders(const BuildJob& job, int threads) {
  std::vector<std::unique_ptr<ShardBuilder>> builders;
  for (int i = 0; i < threads; ++i) builders.push_back(std::make_unique<ShardBuilder>(job));
  return builders;
}

}  // namespace

std::filesystem::path shard_artifact_path(const BuildJob& job, Index3 shard) {
  return fanned_out(job.folder, shard, fmt::format("{}-{}-{}.octree", shard.x, shard.y, shard.z));
}

std::vector<Index3> missing_shards(RunContext& context, const BuildJob& job) {
  const bool trusted = read_stamp(job.folder) == job.volume.stamp;
  std::vector<Index3> missing;
  std::vector<Unit> to_check;
  std::map<std::uint64_t, Hash128> recorded;
  for (const Index3& shard : job.grid.all_shards()) {
    const auto input = recorded_input(job, shard);
    if (!input) {
      missing.push_back(shard);
    } else if (!trusted) {
      recorded[morton_encode(shard)] = *input;
      to_check.push_back(unit_of(job, shard));
    }
  }
  if (to_check.empty()) return missing;

  StageRun stage;
  stage.stage = "check";
  stage.noun = "shards";
  stage.memory = build_memory(context, job);
  const int threads = stage_threads(context, stage.memory);
  const auto builders = make_builders(job, threads);
  std::mutex mutex;
  run_stage(context, stage, to_check, threads, [&](const Unit& unit, WorkerContext& worker) {
    const Index3 shard = morton_decode(unit.key);
    ShardBuilder& builder = *builders[static_cast<std::size_t>(worker.slot())];
    if (builder.input_hash(shard) == recorded.at(unit.key)) return;
    const std::scoped_lock lock(mutex);
    missing.push_back(shard);
  });
  std::sort(missing.begin(), missing.end(),
            [](Index3 x, Index3 y) { return morton_encode(x) < morton_encode(y); });
  return missing;
}

void run_build(RunContext& context, const BuildJob& job) {
  const std::vector<Index3> missing = missing_shards(context, job);
  // Those not missing were just compared with the volume as it is now: from here on its stamp is
  // enough. Stale ones go first, so that none is left to be trusted.
  for (const Index3& shard : missing) std::filesystem::remove(shard_artifact_path(job, shard));
  write_stamp(job.folder, job.volume.stamp);

  StageRun stage;
  stage.stage = "build";
  stage.noun = "shards";
  stage.reused = job.grid.all_shards().size() - missing.size();
  stage.memory = build_memory(context, job);
  const int threads = stage_threads(context, stage.memory);
  std::vector<Unit> units;
  for (const Index3& shard : missing) units.push_back(unit_of(job, shard));
  const auto builders = make_builders(job, threads);
  run_stage(context, stage, units, threads, [&](const Unit& unit, WorkerContext& worker) {
    builders[static_cast<std::size_t>(worker.slot())]->build(morton_decode(unit.key), worker);
  });
}

}  // namespace voxweld
