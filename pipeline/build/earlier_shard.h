// A shard as an earlier build left it, before its edits changed: what of it a new build takes over.
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

  const ArtifactReader& artifact() const { return artifact_; }
  // The brick, if building it now would make the same; else null.
  const BuiltBrick* brick(const BuildJob& job, Index3 brick) const;
  // The run of these bricks, if they were read as one; else null.
  const BuiltRun* run(Index3 first, std::int64_t count) const;

 private:
  EarlierShard(ArtifactReader artifact, ShardHistory history)
      : artifact_(std::move(artifact)), history_(std::move(history)) {}

  ArtifactReader artifact_;
  ShardHistory history_;  // bricks by code
};

}  // namespace voxweld
