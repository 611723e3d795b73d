// One shard from samples to octree artifact, brick by brick.
#pragma once

#include <condition_variable>
#include <memory>
#include <mutex>
#include <optional>

#include "pipeline/build/earlier_shard.h"
#include "pipeline/build/shard_octrees.h"

namespace voxweld {

class ShardBuilders;

class ShardBuilder {
 public:
  // others: of the same job, for threads that help to build a shard; null: none does.
  ShardBuilder(const BuildJob& job, ShardBuilders* others) : job_(job), others_(others) {}

  // Reads, builds and writes the artifact. `worker` is asked to stop between bricks.
  void build(Index3 shard, const WorkerContext& worker);
  // For another builder's shard. Throws NoMemoryLeft where it had to wait for memory.
  std::unique_ptr<RunPieces> build_pieces(const BrickRow& run, const WorkerContext& worker);
  // Reads the samples build would and returns the content hash of them and of the sides that the
  // bricks it need not read are on.
  Hash128 input_hash(Index3 shard);
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
  NanCount nans_of(const BrickRow& run) const;
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
  ShardBuilders* others_;
  Box3 shard_bricks_;              // of the shard at hand
  std::vector<KnownBrick> known_;  // of these, x fastest
  std::vector<std::byte> samples_;
  // Both from the first build on; the share frees the octrees' buffers when it ends.
  std::unique_ptr<ShardOctrees> octrees_;
  std::optional<MemoryShare> share_;
  BrickReport bricks_;
  NanCount nans_;
};

// One for each thread of the stage, for whoever needs one. Thread-safe.
class ShardBuilders {
 public:
  ShardBuilders(const BuildJob& job, int count);

  class Loan {
   public:
    Loan(ShardBuilders& of, ShardBuilder* builder) : of_(&of), builder_(builder) {}
    Loan(const Loan&) = delete;
    Loan& operator=(const Loan&) = delete;
    ~Loan() {
      if (builder_ != nullptr) of_->give_back(builder_);
    }
    explicit operator bool() const { return builder_ != nullptr; }
    ShardBuilder* operator->() const { return builder_; }
    ShardBuilder& operator*() const { return *builder_; }

   private:
    ShardBuilders* of_;
    ShardBuilder* builder_;
  };
  // Waits until one is free; helpers give theirs back soon.
  Loan borrow();
  // None where none is free.
  Loan borrow_if_free();
  const std::vector<std::unique_ptr<ShardBuilder>>& all() const { return all_; }

 private:
  void give_back(ShardBuilder* builder);

  std::vector<std::unique_ptr<ShardBuilder>> all_;
  std::mutex mutex_;
  std::condition_variable freed_;
  std::vector<ShardBuilder*> free_;
};

}  // namespace voxweld
