#include "pipeline/refine/collapse_choice.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "pipeline/executor/probe.h"
#include "stages/refine/threshold.h"
#include "storage/artifact/collapse_survey_artifact.h"
#include "storage/artifact/container.h"
#include "storage/support/error.h"

namespace voxweld {
namespace {

constexpr std::size_t counts_ahead = 1024;

}  // namespace

std::vector<double> tried_tolerances(const RefineJob& job) {
  const RefineParameters& parameters = job.parameters;
  return job.stage == Stage::survey ? survey_tolerances(parameters.reach)
                                    : recount_tolerances(parameters.tolerance, parameters.reach);
}

CollapseChoice::CollapseChoice(ChoiceInputs inputs, bool trust) : inputs_(std::move(inputs)) {
  const auto found = find();
  if (found && trust) {
    chosen_ = found->chosen;
    on_disk_ = true;
    return;
  }
  const Counted counted = read_counts();
  contents_ = counted.contents;
  choose(counted.survey);
  on_disk_ = found && found->sources == contents_ && found->chosen == chosen_;
}

Hash128 CollapseChoice::key() const {
  KeyHasher key;
  key.hash(inputs_.job.key).text("tolerance");
  if (inputs_.first) key.bytes(as_record(*inputs_.first));
  return key.finish();
}

std::optional<ToleranceArtifact> CollapseChoice::find() const {
  const std::filesystem::path path = inputs_.job.tolerance_path();
  if (!std::filesystem::exists(path)) return std::nullopt;
  try {
    ToleranceArtifact found = read_tolerance_artifact(path);
    if (found.key == key()) return found;
  } catch (const DamagedArtifact& damage) {
    spdlog::debug("{}", damage.what());  // it is made again
  }
  return std::nullopt;
}

CollapseChoice::Counted CollapseChoice::read_counts() const {
  const auto& paths = inputs_.counts;
  CollapseSurvey sum;
  sum.left.resize(tried_tolerances(inputs_.counted).size());
  KeyHasher contents;
  probe_in_order<CollapseSurveyArtifact>(
      paths.size(), counts_ahead,
      [&](std::size_t i) {
        if (!std::filesystem::exists(paths[i]))
          throw InputError(
              fmt::format("{}: is missing; run `voxweld {} CONFIG` first, or `voxweld run CONFIG` "
                          "for all",
                          paths[i].string(), stage_name(inputs_.counted.stage)));
        return read_collapse_survey(paths[i]);
      },
      [&](std::size_t i, CollapseSurveyArtifact&& artifact) {
        if (artifact.survey.left.size() != sum.left.size())
          throw DamagedArtifact(paths[i].string(), "is of other tolerances");
        sum.add(artifact.survey);
        contents.hash(artifact.content);
      });
  return {std::move(sum), contents.finish()};
}

void CollapseChoice::choose(const CollapseSurvey& survey) {
  const std::vector<double> tolerances = tried_tolerances(inputs_.counted);
  chosen_ = inputs_.first.value_or(ChosenTolerance{});
  if (!inputs_.first) {
    chosen_.before = survey.all();
    chosen_.target = inputs_.job.target->of(survey.all());
  }
  const CollapseThreshold found = inputs_.first
                                      ? second_threshold(survey, tolerances, chosen_.target)
                                      : first_threshold(survey, tolerances, chosen_.target);
  chosen_.tolerance = found.tolerance;
  chosen_.left = found.triangles;
  chosen_.reached = found.reached ? 1 : 0;
}

void CollapseChoice::write() {
  write_tolerance_artifact(inputs_.job.tolerance_path(), {key(), chosen_, contents_});
  on_disk_ = true;
}

void CollapseChoice::tell() const {
  const RefineJob& job = inputs_.job;
  if (chosen_.target >= chosen_.before)
    spdlog::info(
        "{}: {} triangles are asked for, and there are {}: edges are left that cost anything",
        stage_name(job.stage), chosen_.target, chosen_.before);
  else
    spdlog::info("{}: {} of {} triangles are asked for: edges are collapsed up to {:.4g} voxels",
                 stage_name(job.stage), chosen_.target, chosen_.before,
                 chosen_.tolerance / job.parameters.reach);
  if (!inputs_.first || chosen_.reached != 0) return;
  spdlog::warn(
      "simplify.{}: {} triangles are asked for, and collapsing edges leaves about {}, however far: "
      "small pieces and holes of the surface need the rest (the filters keep and fill take such "
      "away), or the borders of cubes (a larger simplify.tolerance makes fewer there)",
      job.target->triangles ? "triangles" : "ratio", chosen_.target, chosen_.left);
}

}  // namespace voxweld
