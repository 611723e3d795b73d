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

void BrickOctrees::build(const HaloBlock& block, Index3 first, std::int64_t count,
                         const WorkerContext& worker, BrickSink& sink) {
  sink_ = &sink;
  if (job_.parameters.labels.mode == LabelMode::each) labels_.fill(block, job_.parameters);
  for (std::int64_t i = 0; i < count; ++i)
    build_brick(block, first + Index3{i, 0, 0}, worker, sink);
}

void BrickOctrees::build_brick(const HaloBlock& block, Index3 brick, const WorkerContext& worker,
                               BrickSink& sink) {
  sink.begin_brick(brick);
  worker.check_interrupt();
  const BrickPlace place = place_of_brick(job_.grid, brick);
  if (job_.parameters.labels.mode == LabelMode::each) {
    labels_.each(place, job_.parameters, [&](Material material, const BrickOctree& octree) {
      worker.check_interrupt();
      sink.put(material, octree);
    });
  } else {
    voxweld::build_brick(block, place, edits_.around(sign_samples(job_.grid, brick)), scratch_,
                         octree_);
    sink.put(sole_material, octree_);
  }
  sink.end_brick();
}

}  // namespace voxweld
