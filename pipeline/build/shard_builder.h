// One shard from samples to octree artifact, brick by brick.
#pragma once

#include <memory>
#include <optional>

#include "pipeline/build/brick_ranges.h"
#include "pipeline/build/earlier_shard.h"
#include "pipeline/build/shard_octrees.h"

namespace voxweld {

class ShardBuilders;

class ShardBuilder {
 public:
  // others: of the same job, for threads that help to build a shard.
  ShardBuilder(const BuildJob& job, ShardBuilders& others)
      : job_(job), others_(others), ranges_(job) {}

  // Reads, builds and writes the artifact. `worker` is asked to stop between bricks.
  void build(Index3 shard, const WorkerContext& worker);
  // For another builder's shard. Throws NoMemoryLeft where it had to wait for memory.
  std::unique_ptr<RunPieces> build_pieces(const BrickRow& run, const WorkerContext& worker);
  // Reads the samples build would and returns the content hash of them and of the sides that the
  // bricks it need not read are on. read_all: as if no build before had found any.
  Hash128 input_hash(Index3 shard, bool read_all);
  // Of all shards built so far.
  const BrickReport& bricks() const { return bricks_; }
  // Of the samples these were built from, where the volume is read in place: who copies one counts
  // them then.
  const NanCount& nans() const { return nans_; }

 private:
  struct KnownBrick {
    NodeState state = NodeState::split;  // split: it has to be read
    Material material = exterior;        // of labels, where it is inside
  };
  template <class F>
  void each_run(Index3 shard, F&& f);
  template <class F>
  void each_brick(Index3 shard, F&& f) const;
  void look_at(Index3 shard, Hash128 stamp, bool read_all = false);
  std::vector<BrickRow> runs_of(Index3 row, std::int64_t end) const;
  Box3 touched_samples(Index3 brick) const;
  Bounds bounds_of(Index3 brick) const;
  bool meets_ring(Index3 brick) const;
  NodeState unedited_state(Index3 brick) const;
  NodeState side_of(const ValueRange& range, bool in_ring) const;
  std::vector<NodeState> sides_of(const BrickRow& run, std::span<const BrickRange> ranges) const;
  KnownBrick known_label(Index3 brick) const;
  KnownBrick find_known(Index3 brick) const;
  const KnownBrick& known_of(Index3 brick) const;
  void note_sides(Index3 shard, StreamHasher& hash) const;
  NanCount nans_of(const BrickRow& run) const;
  std::vector<BrickRange> ranges_of(const BrickRow& run) const;
  std::optional<ValueRange> range_of_brick(Index3 brick, const Box3& samples) const;
  // Of the run's samples.
  Hash128 read(const BrickRow& run);
  HaloBlock block_of(const BrickRow& run) const;
  std::unique_ptr<RunPieces> pieces_of(const BrickRow& run, const WorkerContext& worker);
  void build(Index3 shard, Hash128 stamp, const EarlierShard* earlier, const WorkerContext& worker);
  void share_memory(const WorkerContext& worker);
  void take_over(Index3 brick, const BuiltBrick& built, const EarlierShard& earlier,
                 const WorkerContext& worker);
  BuiltRun build_run(const BrickRow& run, const EarlierShard* earlier, const WorkerContext& worker);

  const BuildJob& job_;
  ShardBuilders& others_;
  Box3 shard_bricks_;  // of the shard at hand
  BrickRanges ranges_;
  std::vector<KnownBrick> known_;  // of these, x fastest
  std::vector<std::byte> samples_;
  // Both from the first build on; the share frees the octrees' buffers when it ends.
  std::unique_ptr<ShardOctrees> octrees_;
  std::optional<MemoryShare> share_;
  BrickReport bricks_;
  NanCount nans_;
};

}  // namespace voxweld
