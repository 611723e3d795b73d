// The plan of tiles of a refined mesh.
#pragma once

#include <memory>

#include "pipeline/refine/cube_meshes.h"
#include "pipeline/stage/stage_jobs.h"
#include "pipeline/stage/unit_plan.h"
#include "storage/artifact/tile_plan_artifact.h"

namespace voxweld {

class RetilePlan {
 public:
  // meshes: those seams left. Takes the plan that lies in the job's folder where it is of them, and
  // makes it else. trust: the plan is of them, where there is one; a task among many does not look
  // at all of them to know.
  RetilePlan(const RetileJob& job, CubeMeshes& meshes, bool trust);

  const UnitPlan& units() const { return *units_; }
  const std::vector<PlannedTile>& tiles() const { return parts_.tiles; }
  const std::vector<PlanSource>& sources() const { return parts_.sources; }
  // Of all that it was made of.
  Hash128 content() const;
  bool on_disk() const { return on_disk_; }
  void write();

 private:
  const RetileJob& job_;
  TilePlanParts parts_;
  std::unique_ptr<UnitPlan> units_;
  bool on_disk_ = false;
};

}  // namespace voxweld
