#include "storage/artifact/collapse_survey_artifact.h"

#include <algorithm>
#include <functional>

#include "storage/artifact/container.h"

namespace voxweld {
namespace {

enum SurveySection : std::uint64_t { there_section = 1, left_section };

using There = std::array<std::uint64_t, 4>;

}  // namespace

void write_collapse_survey(const std::filesystem::path& path, Hash128 key,
                           const CollapseSurvey& survey) {
  const There there = {survey.inside, survey.fixed, survey.held, survey.border};
  ArtifactWriter out(path, {collapse_survey_kind, collapse_survey_version, key});
  out.section(there_section, as_record(there));
  out.section(left_section, as_section(survey.left));
  out.commit();
}

CollapseSurveyArtifact read_collapse_survey(const std::filesystem::path& path) {
  const ArtifactReader in(path, collapse_survey_kind, collapse_survey_version);
  const auto there = in.read_record<There>(there_section, "has no counts of what is there");
  CollapseSurveyArtifact artifact{in.key(), in.content_hash(), {}};
  CollapseSurvey& survey = artifact.survey;
  survey.inside = there[0];
  survey.fixed = there[1];
  survey.held = there[2];
  survey.border = there[3];
  survey.left = in.read_array<std::uint64_t>(left_section);
  if (survey.held > survey.fixed || !std::ranges::is_sorted(survey.left, std::greater<>()))
    in.damaged("its counts contradict each other");
  return artifact;
}

}  // namespace voxweld
