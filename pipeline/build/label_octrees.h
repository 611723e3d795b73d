// labels.mode = "each": every label of a shard has an octree of its own, built from the samples of
// all of them at once.
#pragma once

#include <optional>

#include "pipeline/build/shard_octrees.h"
#include "stages/build/cut_brick.h"
#include "stages/build/label_bricks.h"
#include "storage/artifact/label_shard_artifact.h"
#include "storage/support/record_sorter.h"

namespace voxweld {

class LabelOctrees : public ShardOctrees {
 public:
  LabelOctrees(const BuildJob& job, MemoryShare& share);

  void free_buffers() override {
    labels_.free_buffers();
    finer_ = cut_ = {};
    cutter_ = {};
  }
  void begin(Index3 shard, Hash128 input_stamp) override;
  void build(const HaloBlock& block, Index3 first, std::int64_t count,
             const WorkerContext& worker) override;
  void inside(Index3 brick, Material material) override;
  void keep(Index3 brick, const BuiltBrick& built, const ArtifactReader& from) override;
  std::uint64_t cut(Index3 brick, const BuiltBrick& built, const ArtifactReader& from) override;
  void finish(Hash128 input, std::vector<BuiltRun> runs) override;

 private:
  class NodeWriter;
  void build_brick(const CellKey& brick, const WorkerContext& worker);
  void begin_brick(Index3 brick);
  void put(Material material, const BrickOctree& octree);
  void end_brick();
  void note(const BuiltBrick& built, bool surface);
  void note(Index3 brick, const PieceHead& head, std::span<const FilledBlock> blocks,
            std::span<const std::byte> record);

  const BuildJob& job_;
  LabelBricks labels_;
  BrickOctree finer_, cut_;
  BrickCutter cutter_;
  MemoryShare& share_;
  Index3 shard_;
  BuiltBrick brick_;                    // under way
  bool any_ = false, surface_ = false;  // of it: pieces, and such that are not all inside
  std::unique_ptr<LabelShardWriter> out_;
  RecordSorter notes_;  // of all pieces, by label and brick
  std::vector<std::byte> note_, record_;
  ShardSummary summary_;
  ShardHistory history_;
};

}  // namespace voxweld
