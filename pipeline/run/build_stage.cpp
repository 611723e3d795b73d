#include "pipeline/run/build_stage.h"

#include <fmt/format.h>

#include <fstream>

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

}  // namespace

std::filesystem::path shard_artifact_path(const BuildJob& job, Index3 shard) {
  return fanned_out(job.folder, shard, fmt::format("{}-{}-{}.octree", shard.x, shard.y, shard.z));
}

std::vector<Index3> missing_shards(const BuildJob& job) {
  const bool trusted = read_stamp(job.folder) == job.volume.stamp;
  ShardBuilder checker(job);
  std::vector<Index3> missing;
  for (const Index3& shard : job.grid.all_shards()) {
    const auto input = recorded_input(job, shard);
    if (!input || (!trusted && checker.input_hash(shard) != *input)) missing.push_back(shard);
  }
  return missing;
}

void run_build(RunContext& context, const BuildJob& job) {
  const std::vector<Index3> missing = missing_shards(job);
  // Those not missing were just compared with the volume as it is now: from here on its stamp is
  // enough. Stale ones go first, so that none is left to be trusted.
  for (const Index3& shard : missing) std::filesystem::remove(shard_artifact_path(job, shard));
  write_stamp(job.folder, job.volume.stamp);

  StageRun stage;
  stage.stage = "build";
  stage.noun = "shards";
  stage.reused = job.grid.all_shards().size() - missing.size();
  stage.memory = {"build", 0, ShardBuilder::memory_bytes(job.grid, job.volume.source->info().type),
                  fmt::format("one brick (work.brick = {})", context.config.work.brick),
                  "raise run.memory or lower work.brick"};
  const int threads = stage_threads(context, stage.memory);
  std::vector<Unit> units;
  for (const Index3& shard : missing) {
    const Box3 bricks = job.grid.shard_bricks(shard);
    units.push_back({morton_encode(shard), fmt::format("shard {}/{}/{}", shard.x, shard.y, shard.z),
                     static_cast<double>(bricks.count())});
  }
  std::vector<std::unique_ptr<ShardBuilder>> builders;
  for (int i = 0; i < threads; ++i) builders.push_back(std::make_unique<ShardBuilder>(job));
  run_stage(context, stage, units, threads, [&](const Unit& unit, WorkerContext& worker) {
    builders[static_cast<std::size_t>(worker.slot())]->build(morton_decode(unit.key), worker);
  });
}

}  // namespace voxweld
