#include "pipeline/build/brick_octrees.h"

namespace voxweld {

BrickOctrees::BrickOctrees(const BuildJob& job, MemoryShare& share)
    : job_(job), edits_(job.parameters) {
  scratch_.reserve = [this, &share](std::uint64_t bytes) {
    share.reserve(bytes + sink_->bytes_held());
  };
  labels_.set_reserve(scratch_.reserve);
}

void BrickOctrees::free_buffers() {
  scratch_.free_buffers();
  labels_.free_buffers();
  octree_ = {};
}

void BrickOctrees::build(const BricksToBuild& bricks, const WorkerContext& worker,
                         BrickSink& sink) {
  sink_ = &sink;
  if (job_.parameters.labels.mode == LabelMode::each) labels_.fill(bricks.block, job_.parameters);
  Index3 brick = bricks.first;
  for (const NodeState side : bricks.sides) {
    build_brick(bricks.block, brick, side, worker, sink);
    ++brick.x;
  }
}

void BrickOctrees::build_brick(const HaloBlock& block, Index3 brick, NodeState side,
                               const WorkerContext& worker, BrickSink& sink) {
  sink.begin_brick(brick);
  worker.check_interrupt();
  const BrickPlace place = place_of_brick(job_.grid, brick);
  if (job_.parameters.labels.mode == LabelMode::each) {
    labels_.each(place, job_.parameters, [&](Material material, const BrickOctree& octree) {
      worker.check_interrupt();
      sink.put(material, octree);
    });
  } else if (side != NodeState::split) {
    build_whole_brick(place, side, octree_);
    sink.put(sole_material, octree_);
  } else {
    voxweld::build_brick(block, place, edits_.around(sign_samples(job_.grid, brick)), scratch_,
                         octree_);
    sink.put(sole_material, octree_);
  }
  sink.end_brick();
}

}  // namespace voxweld
