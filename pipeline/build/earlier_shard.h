// A shard as an earlier build left it: before its edits changed, or at a smaller tolerance. What of
// it a new build takes over or cuts.
#pragma once

#include <optional>

#include "pipeline/stage/artifacts.h"
#include "storage/artifact/shard_summary.h"

namespace voxweld {

class EarlierShard {
 public:
  // Nothing where there is no artifact of the same format, undamaged, made from the very samples
  // the volume has now. stamp: of those.
  static std::optional<EarlierShard> open(const BuildJob& job, Index3 shard, Hash128 stamp);
  // That of job.finer, where it is what a build of that job would make.
  static std::optional<EarlierShard> open_finer(const BuildJob& job, Index3 shard, Hash128 stamp);

  const ArtifactReader& artifact() const { return artifact_; }
  // Whether its bricks are to be cut.
  bool is_finer() const { return finer_; }
  // Whether it left none out by ranges of bricks.
  bool has_read_all() const { return read_summary(artifact_).unread == 0; }
  // The brick, if building it now would make the same, or a cut of it; else null.
  const BuiltBrick* brick(Index3 brick) const;
  // The run of these bricks, if they were read as one; else null.
  const BuiltRun* run(Index3 first, std::int64_t count) const;

 private:
  EarlierShard(const BuildJob& job, ArtifactReader artifact, ShardHistory history)
      : job_(&job), artifact_(std::move(artifact)), history_(std::move(history)) {}

  const BuildJob* job_;  // whose it is
  bool finer_ = false;
  ArtifactReader artifact_;
  ShardHistory history_;  // bricks by code
};

}  // namespace voxweld
