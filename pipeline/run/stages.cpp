#include "pipeline/run/stages.h"

#include <fmt/format.h>

#include <stdexcept>

#include "pipeline/build/build_stage.h"
#include "pipeline/encode/encode_stage.h"
#include "pipeline/ingest/ingest_stage.h"
#include "pipeline/merge/merge_stage.h"
#include "pipeline/refine/find_stage.h"
#include "pipeline/refine/levels_stage.h"
#include "pipeline/refine/mend_stage.h"
#include "pipeline/refine/refine_stage.h"
#include "pipeline/refine/retile_stage.h"
#include "pipeline/refine/survey_stage.h"
#include "pipeline/stitch/stitch_stage.h"
#include "storage/support/error.h"

namespace voxweld {

StageWork& Stages::open(Stage stage) {
  std::unique_ptr<StageWork>& work = works_[static_cast<std::size_t>(stage)];
  if (work == nullptr) work = make(stage);
  return *work;
}

std::unique_ptr<StageWork> Stages::make(Stage stage) {
  if (stage == Stage::ingest) return ingest_stage(context_.config, jobs_.ingest());
  if (!volume_is_open_) {
    jobs_.open_volume(context_.config);
    if (context_.extraction)
      jobs_.cut(context_.config, *context_.extraction);
    else
      jobs_.cut_what_is_there(context_.config);
  }
  volume_is_open_ = true;
  if (stage > Stage::merge) fit_cubes();
  switch (stage) {
    case Stage::build:
      return build_stage(jobs_.build());
    case Stage::merge:
      return merge_stage(jobs_.merge());
    case Stage::stitch:
      return stitch_stage(jobs_.stitch(), top(), merged_plan());
    case Stage::survey:
    case Stage::refine:
    case Stage::recount:
    case Stage::seams:
    case Stage::mend:
    case Stage::remend:
      return make_refine(stage);
    case Stage::retile:
      return retile_stage(jobs_.retile(), refined(), retile_plan());
    case Stage::levels:
      return levels_stage(level_sources());
    case Stage::encode:
      return encode_stage(
          {context_.config, jobs_.encode(),
           refines(context_.config) ? retile_plan().content() : top().content_hash(), plan(),
           level_meshes(), [this] { return manifest(); }});
    case Stage::ingest:
      break;
  }
  throw std::logic_error("no such stage");
}

// Once, before any stage looks for its artifacts.
void Stages::fit_cubes() {
  if (has_target(context_.config) && !cubes_fit_)
    jobs_.fit_cubes(context_.config, top().counts().vertices);
  cubes_fit_ = true;
}

bool Stages::folders_are_known() {
  if (!has_target(context_.config)) return true;
  if (!merge_is_there(jobs_.merge())) return false;
  fit_cubes();
  return true;
}

std::unique_ptr<StageWork> Stages::make_refine(Stage stage) {
  const std::uint64_t tile_vertices = jobs_.merge().tile_vertices;
  const std::vector<RefineUnit>& units = refine_units();
  const auto inputs = [&](const RefineJob& job, std::vector<MeshLayer> meshes) {
    return RefineInputs{job, units, std::move(meshes), tile_vertices};
  };
  const auto with_choice = [&](RefineInputs all) {
    all.choice = choice(stage);
    return all;
  };
  const bool repairs = only_repairs(context_.config);
  switch (stage) {
    case Stage::survey:
      return survey_stage(inputs(jobs_.survey(), {layer_of(Stage::stitch)}));
    case Stage::refine:
      if (repairs) return find_stage(inputs(jobs_.refine(), {layer_of(Stage::stitch)}));
      return refine_stage(with_choice(inputs(jobs_.refine(), {layer_of(Stage::stitch)})));
    case Stage::recount:
      choice(Stage::refine);
      return survey_stage(inputs(jobs_.recount(), {layer_of(Stage::refine)}));
    case Stage::seams:
      if (!repairs)
        return refine_stage(with_choice(inputs(jobs_.seams(), {layer_of(Stage::refine)})));
      break;
    default:
      break;
  }
  RefineInputs mend = inputs(refine_job(stage), layers_before(stage));
  if (stage == Stage::remend)
    mend.places = layer_of(Stage::mend);
  else if (repairs)
    mend.places = layer_of(stage == Stage::seams ? Stage::refine : Stage::seams);
  return mend_stage(mend);
}

const RefineJob& Stages::refine_job(Stage stage) const {
  switch (stage) {
    case Stage::seams:
      return jobs_.seams();
    case Stage::mend:
      return jobs_.mend();
    case Stage::remend:
      return jobs_.remend();
    default:
      return jobs_.refine();
  }
}

MeshLayer Stages::layer_of(Stage maker) {
  if (maker != Stage::stitch) return {maker, refined_meshes(refine_job(maker), refine_units())};
  MeshLayer stitched{maker, {}};
  for (std::uint64_t unit = 0; unit < merged_plan().size(); ++unit)
    stitched.paths.push_back(stitch_artifact_path(jobs_.stitch(), merged_plan(), unit));
  return stitched;
}

// The mesh as a stage after the first pass finds it.
std::vector<MeshLayer> Stages::layers_before(Stage stage) {
  std::vector<MeshLayer> layers;
  if (only_repairs(context_.config)) layers.push_back(layer_of(Stage::stitch));
  for (const Stage maker : {Stage::seams, Stage::mend, Stage::remend})
    if (maker < stage && has_stage(context_.config, maker)) layers.push_back(layer_of(maker));
  return layers;
}

CollapseChoice* Stages::choice(Stage stage) {
  if (!has_target(context_.config)) return nullptr;
  const bool seams = stage == Stage::seams;
  std::unique_ptr<CollapseChoice>& known = seams ? seams_choice_ : refine_choice_;
  if (known != nullptr) return known.get();
  std::optional<ChosenTolerance> first;
  if (seams) first = choice(Stage::refine)->chosen();
  const RefineJob& job = seams ? jobs_.seams() : jobs_.refine();
  const RefineJob& counted = seams ? jobs_.recount() : jobs_.survey();
  known = std::make_unique<CollapseChoice>(
      ChoiceInputs{job, counted, refined_meshes(counted, refine_units()), first},
      context_.inputs_checked);
  jobs_.set_tolerance(stage, known->chosen().tolerance);
  return known.get();
}

Manifest Stages::manifest() {
  check_input();
  std::optional<RefineFigures> figures;
  if (refines(context_.config)) figures = {refine_counts(jobs_.refine(), refine_units())};
  for (const Stage stage : {Stage::seams, Stage::mend, Stage::remend})
    if (has_stage(context_.config, stage))
      figures->later.push_back(refine_counts(refine_job(stage), refine_units()));
  if (figures) figures->first_patch = only_repairs(context_.config) ? 0 : 1;
  if (const CollapseChoice* const last = choice(Stage::seams)) figures->target = last->chosen();
  return make_manifest(context_, jobs_, top(), figures);
}

void Stages::check_input() {
  const IngestJob& job = jobs_.ingest();
  std::optional<std::string> changed = changed_file(job);
  if (!changed && lies_in_unlisted_files(job)) {
    const StageLook look = open(job.copy ? Stage::ingest : Stage::build).look({});
    if (!look.missing.empty() || !look.unproven.empty()) changed = context_.config.input.path;
  }
  if (!changed) return;
  throw InputError(
      fmt::format("{}: changed while it was read, so the result would be of the old and the new; "
                  "run again when it is complete",
                  *changed));
}

const TopArtifact& Stages::top() {
  if (!top_) top_.emplace(jobs_.merge().path());
  return *top_;
}

const UnitPlan& Stages::merged_plan() {
  if (plan_ == nullptr)
    plan_ = unit_plan(top(), context_.config.labels.mode, collapses_by_sheets(context_.config));
  return *plan_;
}

const UnitPlan& Stages::plan() {
  return refines(context_.config) ? retile_plan().units() : merged_plan();
}

const std::vector<RefineUnit>& Stages::refine_units() {
  if (!refine_units_) {
    const RefineFrame& frame = jobs_.refine().frame;
    refine_units_ = voxweld::refine_units(top(), context_.config.labels.mode, cubes_of(frame));
  }
  return *refine_units_;
}

CubeMeshes& Stages::refined() {
  if (refined_) return *refined_;
  return refined_.emplace(layers_before(Stage::retile));
}

NodeSources Stages::level_sources() {
  choice(Stage::seams);  // of the tolerance
  if (!level_tree_) {
    const LevelsJob& job = jobs_.levels();
    const bool each = context_.config.labels.mode == LabelMode::each;
    const std::uint64_t tile = jobs_.retile().tile_vertices;
    level_tree_.emplace(retile_plan().level_leaves(),
                        LevelTreeRules{job.levels, job.frame.level, each ? tile : 0, each, tile,
                                       job.parameters.tolerance / job.parameters.reach});
  }
  return {jobs_.levels(), *level_tree_, refined()};
}

const LevelMeshes* Stages::level_meshes() {
  if (!has_levels(context_.config)) return nullptr;
  if (!level_meshes_) level_meshes_.emplace(jobs_.levels(), level_sources().tree);
  return &*level_meshes_;
}

RetilePlan& Stages::retile_plan() {
  const bool one_of_many = context_.inputs_checked || !context_.selection.all();
  if (!retile_plan_)
    retile_plan_.emplace(
        RetileInputs{jobs_.retile(), refined(), top(), context_.config.labels.mode}, one_of_many);
  return *retile_plan_;
}

}  // namespace voxweld
