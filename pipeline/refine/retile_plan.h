// The plan of tiles of a refined mesh, or of the meshes of labels.
#pragma once

#include <memory>

#include "pipeline/refine/cube_meshes.h"
#include "pipeline/stage/stage_jobs.h"
#include "pipeline/stage/unit_plan.h"
#include "storage/artifact/tile_plan_artifact.h"

namespace voxweld {

// One mesh of a unit.
struct RefinedTile {
  Material label = 0;  // 0 of one surface
  PlannedTile tile;
};

class RetilePlan {
 public:
  virtual ~RetilePlan() = default;

  virtual const UnitPlan& units() const = 0;
  // Of a unit, in the order of its meshes. Thread-safe.
  virtual std::vector<RefinedTile> tiles(std::uint64_t unit) const = 0;
  // Of all that it was made of.
  virtual Hash128 content() const = 0;
  // Puts it where the job has it.
  virtual void write() = 0;

  bool on_disk() const { return on_disk_; }
  const std::vector<PlanSource>& sources() const { return sources_; }

 protected:
  std::vector<PlanSource> sources_;
  bool on_disk_ = false;
};

// What a plan refers to, and outlives it.
struct RetileInputs {
  const RetileJob& job;
  CubeMeshes& meshes;      // those the last pass left
  const TopArtifact& top;  // whose labels they are
  LabelMode labels = LabelMode::off;
};

// Takes the plan that lies in the job's folder where it is of these meshes, and makes it else.
// trust: the plan is of them, where there is one; a task among many does not look at all of them to
// know.
std::unique_ptr<RetilePlan> retile_plan(const RetileInputs& inputs, bool trust);

}  // namespace voxweld
