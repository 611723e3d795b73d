// One shard from samples to octree artifact, brick by brick.
#pragma once

#include <optional>

#include "pipeline/build/earlier_shard.h"
#include "pipeline/build/shard_octrees.h"

namespace voxweld {

class ShardBuilder {
 public:
  explicit ShardBuilder(const BuildJob& job) : job_(job) {}

  // Reads, builds and writes the artifact. `worker` is asked to stop between bricks.
  void build(Index3 shard, const WorkerContext& worker);
  // Reads the samples build would and returns the content hash of them and of the sides that the
  // bricks it need not read are on.
  Hash128 input_hash(Index3 shard);
  // Of all shards built so far.
  const BrickReport& bricks() const { return bricks_; }
  // Of the samples these were built from, where the volume is read in place: who copies one counts
  // them then.
  const NanCount& nans() const { return nans_; }

 private:
  struct BrickRow {  // bricks along x that are read together
    Index3 first;
    std::int64_t count = 0;
    Box3 samples;
  };
  struct KnownBrick {
    NodeState state = NodeState::split;  // split: it has to be read
    Material material = exterior;        // of labels, where it is inside
  };
  template <class F>
  void each_run(Index3 shard, F&& f);
  template <class F>
  void each_brick(Index3 shard, F&& f) const;
  void look_at(Index3 shard);
  std::vector<BrickRow> runs_of(Index3 row, std::int64_t end) const;
  Box3 touched_samples(Index3 brick) const;
  Bounds bounds_of(Index3 brick) const;
  bool meets_ring(Index3 brick) const;
  NodeState unedited_state(Index3 brick) const;
  KnownBrick known_label(Index3 brick) const;
  KnownBrick find_known(Index3 brick) const;
  const KnownBrick& known_of(Index3 brick) const;
  void note_sides(Index3 shard, StreamHasher& hash) const;
  void count_nans_of(const BrickRow& run);
  // Of the run's samples.
  Hash128 read(const BrickRow& run);
  void build(Index3 shard, Hash128 stamp, const EarlierShard* earlier, const WorkerContext& worker);
  void share_memory(const WorkerContext& worker);
  void take_over(Index3 brick, const BuiltBrick& built, const EarlierShard& earlier,
                 const WorkerContext& worker);
  BuiltRun build_run(const BrickRow& run, const EarlierShard* earlier, const WorkerContext& worker);

  const BuildJob& job_;
  Box3 shard_bricks_;              // of the shard at hand
  std::vector<KnownBrick> known_;  // of these, x fastest
  std::vector<std::byte> samples_;
  // Both from the first build on; the share frees the octrees' buffers when it ends.
  std::unique_ptr<ShardOctrees> octrees_;
  std::optional<MemoryShare> share_;
  BrickReport bricks_;
  NanCount nans_;
};

}  // namespace voxweld
