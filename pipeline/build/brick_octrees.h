// From the samples of bricks to the octree pieces of each: one for each material, which are the labels
// (labels.mode = "each"), built from the samples of all of them at once; else there is one.
#pragma once

#include "pipeline/build/local_edits.h"
#include "pipeline/executor/memory_pool.h"
#include "pipeline/stage/artifacts.h"
#include "pipeline/stage/context.h"
#include "stages/build/build_brick.h"
#include "stages/build/label_bricks.h"

namespace voxweld {

// Where the pieces go: of each brick begin_brick, its pieces by material, end_brick.
class BrickSink {
 public:
  virtual ~BrickSink() = default;
  virtual void begin_brick(Index3 brick) = 0;
  virtual void put(Material material, const BrickOctree& octree) = 0;
  virtual void end_brick() = 0;
  // What of the pieces lies in memory; MemoryShare::reserve is told.
  virtual std::uint64_t bytes_held() const { return 0; }
};

// Bricks along x from `first` on, of samples that reach as far around them as they need.
struct BricksToBuild {
  HaloBlock block;
  Index3 first;
  // Of each: which side all samples that its cells touch are known to be on; split: not known.
  std::span<const NodeState> sides;
};

class BrickOctrees {
 public:
  // Bricks take their memory from `share`. Both live longer.
  BrickOctrees(const BuildJob& job, MemoryShare& share);

  // `worker` is asked to stop between bricks.
  void build(const BricksToBuild& bricks, const WorkerContext& worker, BrickSink& sink);
  // Gives what bricks have left behind back to the system.
  void free_buffers();

 private:
  void build_brick(const HaloBlock& block, Index3 brick, NodeState side,
                   const WorkerContext& worker, BrickSink& sink);

  const BuildJob& job_;
  LocalEdits edits_;
  BrickScratch scratch_;
  LabelBricks labels_;  // of labels in place of these two
  BrickOctree octree_;
  const BrickSink* sink_ = nullptr;  // of the bricks under way
};

}  // namespace voxweld
