#include "pipeline/build/earlier_shard.h"

#include <algorithm>

#include "storage/support/error.h"
#include "storage/types/morton.h"

namespace voxweld {

std::optional<EarlierShard> EarlierShard::open(const BuildJob& job, Index3 shard, Hash128 stamp) {
  const auto path = shard_artifact_path(job, shard);
  if (!std::filesystem::exists(path)) return std::nullopt;
  try {
    ArtifactReader artifact = open_octrees(job, shard);
    if (artifact.input_stamp() != stamp) return std::nullopt;
    ShardHistory history = read_history(artifact);
    std::sort(history.bricks.begin(), history.bricks.end(),
              [](const BuiltBrick& a, const BuiltBrick& b) { return a.code < b.code; });
    return EarlierShard(job, std::move(artifact), std::move(history));
  } catch (const DamagedArtifact&) {
    return std::nullopt;  // it is being replaced
  }
}

std::optional<EarlierShard> EarlierShard::open_finer(const BuildJob& job, Index3 shard,
                                                     Hash128 stamp) {
  if (job.finer == nullptr) return std::nullopt;
  std::optional<EarlierShard> found = open(*job.finer, shard, stamp);
  if (found && found->artifact().key() != shard_key(*job.finer, shard)) found.reset();
  if (found) found->finer_ = true;
  return found;
}

const BuiltBrick* EarlierShard::brick(Index3 brick) const {
  const std::uint64_t code = morton_encode(brick);
  const auto found =
      std::lower_bound(history_.bricks.begin(), history_.bricks.end(), code,
                       [](const BuiltBrick& b, std::uint64_t c) { return b.code < c; });
  if (found == history_.bricks.end() || found->code != code) return nullptr;
  return found->key == brick_key(*job_, brick) ? &*found : nullptr;
}

const BuiltRun* EarlierShard::run(Index3 first, std::int64_t count) const {
  for (const BuiltRun& run : history_.runs)
    if (run.first == first && run.count == count) return &run;
  return nullptr;
}

}  // namespace voxweld
