#include "pipeline/run/stages.h"

#include <fmt/format.h>

#include <stdexcept>

#include "pipeline/build/build_stage.h"
#include "pipeline/encode/encode_stage.h"
#include "pipeline/ingest/ingest_stage.h"
#include "pipeline/merge/merge_stage.h"
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
      return stitch_stage(jobs_.stitch(), top(), plan());
    case Stage::encode:
      return encode_stage({context_.config, jobs_.encode(), top(), plan(), [this] {
                             check_input();
                             return make_manifest(context_, jobs_, top());
                           }});
    case Stage::ingest:
      break;
  }
  throw std::logic_error("no such stage");
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

const UnitPlan& Stages::plan() {
  if (plan_ == nullptr) plan_ = unit_plan(top(), context_.config.labels.mode);
  return *plan_;
}

}  // namespace voxweld
