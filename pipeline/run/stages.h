// The stages of one config, in their order, each made when those before it are current.
#pragma once

#include <array>
#include <memory>
#include <optional>

#include "pipeline/refine/collapse_choice.h"
#include "pipeline/refine/node_reads.h"
#include "pipeline/refine/retile_plan.h"
#include "pipeline/run/jobs.h"
#include "pipeline/stage/level_meshes.h"
#include "pipeline/stage/stage_work.h"
#include "pipeline/stage/unit_plan.h"
#include "storage/artifact/top_artifact.h"

namespace voxweld {

class Stages {
 public:
  // Opens the input. context: outlives this; open() resolves what of its config only the volume can
  // tell (the isovalue).
  explicit Stages(RunContext& context)
      : context_(context), jobs_(context.config, context.interrupt) {}

  Jobs& jobs() { return jobs_; }
  // Precondition: the stages before it are current, or known to be enough for the units asked for.
  StageWork& open(Stage stage);
  // Folders of the stages behind merge, which of a run that asks for a number of triangles are known
  // once merge is current.
  bool folders_are_known();
  // The top tree, opened once. Precondition: merge is current.
  const TopArtifact& top();
  // Merge's plan of tiles: what stitch works by.
  const UnitPlan& merged_plan();
  // The tiles that encode takes: those of merge's plan, or of the refined mesh. Precondition: the
  // stages before encode are current.
  const UnitPlan& plan();
  // Throws InputError where the input is not what it was when these stages were planned: what was
  // made meanwhile may be of both. Stages know by their stamps what of it to make again.
  void check_input();

 private:
  std::unique_ptr<StageWork> make(Stage stage);
  void fit_cubes();
  std::unique_ptr<StageWork> make_refine(Stage stage);
  const RefineJob& refine_job(Stage stage) const;  // of refine, or what comes behind it
  MeshLayer layer_of(Stage maker);
  std::vector<MeshLayer> layers_before(Stage stage);
  // With a target: the tolerance of refine or seams, put into its job.
  CollapseChoice* choice(Stage stage);
  const std::vector<RefineUnit>& refine_units();
  // What the last pass left, and the tiles planned of it.
  CubeMeshes& refined();
  RetilePlan& retile_plan();
  // What levels are made of, and what is made. Of a config that has some.
  NodeSources level_sources();
  const LevelMeshes* level_meshes();
  Manifest manifest();

  RunContext& context_;
  Jobs jobs_;
  bool volume_is_open_ = false, cubes_fit_ = false;
  std::optional<TopArtifact> top_;
  std::unique_ptr<UnitPlan> plan_;
  std::optional<std::vector<RefineUnit>> refine_units_;
  std::optional<CubeMeshes> refined_;
  std::unique_ptr<CollapseChoice> refine_choice_, seams_choice_;
  std::optional<RetilePlan> retile_plan_;
  std::optional<LevelTree> level_tree_;
  std::optional<LevelMeshes> level_meshes_;
  std::array<std::unique_ptr<StageWork>, all_stages.size()> works_;
};

}  // namespace voxweld
