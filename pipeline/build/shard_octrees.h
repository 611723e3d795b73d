// What build makes of the samples of one shard, once they are read: an octree piece for each brick,
// and the nodes above them as far as the shard reaches.
#pragma once

#include <memory>

#include "pipeline/executor/memory_pool.h"
#include "pipeline/stage/artifacts.h"
#include "pipeline/stage/context.h"
#include "stages/build/build_brick.h"
#include "stages/merge/shard_reduction.h"
#include "storage/artifact/shard_artifact.h"
#include "storage/types/material.h"

namespace voxweld {

// One shard at a time: begin, the bricks in any order, finish.
class ShardOctrees {
 public:
  virtual ~ShardOctrees() = default;
  // Gives what bricks have left behind back to the system.
  virtual void free_buffers() = 0;
  virtual void begin(Index3 shard, Hash128 input_stamp) = 0;
  // `count` bricks along x from `first` on, of samples that reach as far around them as they need.
  // `worker` is asked to stop between bricks.
  virtual void build(const HaloBlock& block, Index3 first, std::int64_t count,
                     const WorkerContext& worker) = 0;
  // A brick that is all inside, or of this material, as is known without its samples.
  virtual void inside(Index3 brick, Material material) = 0;
  // In place of build(), takes a brick over from the artifact that an earlier build of the same
  // samples left. DamagedArtifact when that fails its checks.
  virtual void keep(Index3 brick, const BuiltBrick& built, const ArtifactReader& from) = 0;
  // The same of one of the same samples at a smaller tolerance. Where each sheet collapses by itself
  // only. Returns the bytes read.
  virtual std::uint64_t cut(Index3 brick, const BuiltBrick& built, const ArtifactReader& from) = 0;
  // Writes the artifact. input: of all that was read; runs: those.
  virtual void finish(Hash128 input, std::vector<BuiltRun> runs) = 0;
};

// The one for labels.mode of the job. Bricks take their memory from `share`, which lives longer.
std::unique_ptr<ShardOctrees> make_shard_octrees(const BuildJob& job, MemoryShare& share);

}  // namespace voxweld
