// One shard from samples to octree artifact, brick by brick.
#pragma once

#include "pipeline/run/build_stage.h"
#include "stages/build/build_brick.h"
#include "stages/merge/octree_reduction.h"
#include "storage/artifact/shard_artifact.h"

namespace voxweld {

class ShardBuilder {
 public:
  explicit ShardBuilder(const BuildJob& job) : job_(job) {}

  // Reads, builds and writes the artifact. `worker` is asked to stop between bricks.
  void build(Index3 shard, const WorkerContext& worker);
  // Reads the samples build would and returns the content hash of them and of the sides that the
  // bricks it need not read are on.
  Hash128 input_hash(Index3 shard);

  // The samples build reads, or would were no brick left out.
  static Box3 shard_samples(const BuildJob& job, Index3 shard);

  // Where the shard's signs are looked at, for edits: spacing * sample index.
  static Bounds shard_bounds(const BuildJob& job, Index3 shard);

  // Bytes of one builder at work on one shard, whatever the samples.
  static std::uint64_t memory_bytes(const BrickGrid& grid, SampleType type);

 private:
  struct Run {  // bricks along x that are read together
    Index3 first;
    std::int64_t count = 0;
    Box3 samples;
  };
  struct Root {
    NodeSummary node;
    std::vector<BlockCount> blocks;
  };
  template <class F>
  void each_run(Index3 shard, F&& f);
  std::vector<Run> runs_of(Index3 row, std::int64_t end) const;
  Box3 touched_samples(Index3 brick) const;
  bool meets_ring(Index3 brick) const;
  NodeState unedited_state(Index3 brick) const;
  NodeState skip_state(Index3 brick) const;
  void note_sides(Index3 shard, StreamHasher& hash) const;
  void read(const Run& run, StreamHasher& hash);
  void build_run(const Run& run, ShardArtifactWriter& out, const WorkerContext& worker);
  std::vector<ShardNode> reduce(Index3 shard);

  const BuildJob& job_;
  std::vector<std::byte> samples_;
  BrickScratch scratch_;
  BrickOctree brick_;
  std::vector<Root> roots_;
  ShardSummary summary_;
};

}  // namespace voxweld
