// What build makes of the samples of one shard, once they are read: for each material of a brick an
// octree piece, and the nodes above them as far as the shard reaches.
#pragma once

#include <memory>

#include "pipeline/build/brick_octrees.h"
#include "pipeline/build/run_pieces.h"
#include "stages/build/cut_brick.h"
#include "storage/artifact/shard_artifact.h"
#include "storage/support/record_sorter.h"

namespace voxweld {

// One shard at a time: begin, the bricks in any order, finish.
class ShardOctrees final : private BrickSink {
 public:
  // Bricks take their memory from `share`. Both live longer.
  ShardOctrees(const BuildJob& job, MemoryShare& share);

  // Gives what bricks have left behind back to the system.
  void free_buffers();
  void begin(Index3 shard, Hash128 input_stamp);
  // As BrickOctrees::build; into the artifact, or into `out`.
  void build(const BricksToBuild& bricks, const WorkerContext& worker);
  void build(const BricksToBuild& bricks, const WorkerContext& worker, BrickSink& out);
  // What another one has built so.
  void add_run(const RunPieces& run);
  // A brick that is all inside, or of this material, as is known without its samples.
  void inside(Index3 brick, Material material);
  // In place of build(), takes a brick over from the artifact that an earlier build of the same
  // samples left. DamagedArtifact when that fails its checks.
  void keep(Index3 brick, const BuiltBrick& built, const ArtifactReader& from);
  // The same of one of the same samples at a smaller tolerance. Where each sheet collapses by itself
  // only. Returns the bytes read.
  std::uint64_t cut(Index3 brick, const BuiltBrick& built, const ArtifactReader& from);
  // Writes the artifact. input: of all that was read; runs: those; unread: bricks left out by ranges of
  // an earlier build.
  void finish(Hash128 input, std::vector<BuiltRun> runs, std::uint64_t unread);

 private:
  class NodeWriter;
  void begin_brick(Index3 brick) override;
  void put(Material material, const BrickOctree& octree) override;
  void end_brick() override;
  void note(const BuiltBrick& built, bool surface);
  void note(const PieceHead& head, std::span<const FilledBlock> blocks,
            std::span<const std::byte> record);

  const BuildJob& job_;
  BrickOctrees bricks_;
  BrickOctree cut_, finer_;
  BrickCutter cutter_;
  MemoryShare& share_;
  Index3 shard_;
  BuiltBrick brick_;                    // under way
  bool any_ = false, surface_ = false;  // of it: pieces, and such that are not all inside
  std::unique_ptr<ShardArtifactWriter> out_;
  RecordSorter notes_;  // of all pieces, by material and brick
  std::vector<std::byte> note_;
  AboveBytes above_;
  ShardSummary summary_;
  ShardHistory history_;
};

}  // namespace voxweld
