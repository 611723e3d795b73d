// The plan of tiles of a refined mesh: of a list of materials, as merge has it.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "pipeline/refine/cube_meshes.h"
#include "pipeline/stage/level_tree.h"
#include "pipeline/stage/stage_jobs.h"
#include "pipeline/stage/unit_plan.h"
#include "storage/artifact/tile_plan_artifact.h"

namespace voxweld {

// What a plan refers to, and outlives it.
struct RetileInputs {
  const RetileJob& job;
  CubeMeshes& meshes;      // those the last pass left
  const TopArtifact& top;  // whose materials they are of
  LabelMode labels = LabelMode::off;
};

// A file from the start, which is elsewhere until write(): so what it takes in memory is what merge's
// plan does.
class RetilePlan {
 public:
  // Takes the plan that lies in the job's folder where it is of these meshes, and makes it else.
  // trust: the plan is of them, where there is one; a task among many does not look at all of them to
  // know.
  RetilePlan(const RetileInputs& inputs, bool trust);
  ~RetilePlan();
  RetilePlan(const RetilePlan&) = delete;
  RetilePlan& operator=(const RetilePlan&) = delete;

  const UnitPlan& units() const { return *units_; }
  const std::vector<PlanSource>& sources() const { return sources_; }
  // What levels of detail are made of, in the order of units. Of labels a million of them are many: they
  // are not held here.
  std::vector<LevelLeaf> level_leaves() const;
  // Of all that it was made of.
  Hash128 content() const { return artifact_->content_hash(); }
  bool on_disk() const { return scratch_.empty(); }
  // Puts it where the job has it.
  void write();

 private:
  bool take_from_disk(const RetileInputs& inputs, bool trust);
  void make(const RetileInputs& inputs) const;
  void open(std::unique_ptr<TilePlanArtifact> artifact);

  const RetileJob& job_;
  const Hash128 key_;
  const LabelMode labels_;
  std::filesystem::path scratch_;  // empty: it is where the job has it
  std::unique_ptr<TilePlanArtifact> artifact_;
  std::vector<PlanSource> sources_;
  std::optional<UnitPlan> units_;
};

}  // namespace voxweld
