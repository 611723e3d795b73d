#include "pipeline/run/stages.h"

#include <fmt/format.h>

#include <stdexcept>

#include "pipeline/build/build_stage.h"
#include "pipeline/encode/encode_stage.h"
#include "pipeline/ingest/ingest_stage.h"
#include "pipeline/merge/merge_stage.h"
#include "pipeline/refine/refine_stage.h"
#include "pipeline/refine/retile_stage.h"
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
  if (!volume_is_open_) jobs_.open_volume(context_.config);
  volume_is_open_ = true;
  switch (stage) {
    case Stage::build:
      return build_stage(jobs_.build());
    case Stage::merge:
      return merge_stage(jobs_.merge());
    case Stage::stitch:
      return stitch_stage(jobs_.stitch(), top(), merged_plan());
    case Stage::refine:
    case Stage::seams:
      return make_refine(stage);
    case Stage::retile:
      return retile_stage(jobs_.retile(), refined(), retile_plan());
    case Stage::encode:
      return encode_stage(
          {context_.config, jobs_.encode(),
           refines(context_.config) ? retile_plan().content() : top().content_hash(), plan(),
           [this] { return manifest(); }});
    case Stage::ingest:
      break;
  }
  throw std::logic_error("no such stage");
}

std::unique_ptr<StageWork> Stages::make_refine(Stage stage) {
  const std::uint64_t tile_vertices = jobs_.merge().tile_vertices;
  if (stage == Stage::seams)
    return refine_stage({jobs_.seams(), refine_units(), Stage::refine,
                         refined_meshes(jobs_.refine(), refine_units()), tile_vertices});
  std::vector<std::filesystem::path> stitched;
  for (std::uint64_t unit = 0; unit < merged_plan().size(); ++unit)
    stitched.push_back(stitch_artifact_path(jobs_.stitch(), merged_plan(), unit));
  return refine_stage(
      {jobs_.refine(), refine_units(), Stage::stitch, std::move(stitched), tile_vertices});
}

Manifest Stages::manifest() {
  check_input();
  std::optional<RefineFigures> figures;
  if (refines(context_.config))
    figures = {refine_counts(jobs_.refine(), refine_units()),
               refine_counts(jobs_.seams(), refine_units())};
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
  if (plan_ == nullptr) plan_ = unit_plan(top(), context_.config.labels.mode);
  return *plan_;
}

const UnitPlan& Stages::plan() {
  return refines(context_.config) ? retile_plan().units() : merged_plan();
}

const std::vector<RefineUnit>& Stages::refine_units() {
  if (!refine_units_) refine_units_ = voxweld::refine_units(top(), context_.config.labels.mode);
  return *refine_units_;
}

CubeMeshes& Stages::refined() {
  if (!refined_) refined_.emplace(Stage::seams, refined_meshes(jobs_.seams(), refine_units()));
  return *refined_;
}

RetilePlan& Stages::retile_plan() {
  const bool one_of_many = context_.inputs_checked || !context_.selection.all();
  if (retile_plan_ == nullptr)
    retile_plan_ = voxweld::retile_plan(
        {jobs_.retile(), refined(), top(), context_.config.labels.mode}, one_of_many);
  return *retile_plan_;
}

}  // namespace voxweld
