#include "storage/artifact/collapse_survey_artifact.h"

#include <gtest/gtest.h>

#include "storage/artifact/tolerance_artifact.h"
#include "storage/support/error.h"
#include "storage/support/file_io.h"
#include "tests/support/temp_directory.h"

namespace voxweld {
namespace {

using testing::TempDirectory;

CollapseSurvey some_counts() {
  CollapseSurvey survey;
  survey.inside = 90;
  survey.fixed = 10;
  survey.held = 2;
  survey.border = 12;
  survey.left = {80, 50, 50};
  return survey;
}

constexpr ChosenTolerance chosen{12.5, 1000, 100, 99, 1};

// Each byte in turn, and each length.
template <class Read>
void expect_damage_is_found(const std::filesystem::path& path, const Read& read) {
  const auto bytes = read_whole_file(path);
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    auto wrong = bytes;
    wrong[i] ^= std::byte{16};
    write_whole_file(path, wrong, Durability::rename_only);
    EXPECT_THROW(read(), DamagedArtifact) << i;
    wrong.resize(i);
    write_whole_file(path, wrong, Durability::rename_only);
    EXPECT_THROW(read(), DamagedArtifact) << i;
  }
}

TEST(CollapseSurveyFile, ReadsBack) {
  const TempDirectory directory;
  write_collapse_survey(directory / "a.counts", {1, 2}, some_counts());
  const CollapseSurveyArtifact found = read_collapse_survey(directory / "a.counts");
  EXPECT_EQ(found.key, (Hash128{1, 2}));
  EXPECT_EQ(found.survey, some_counts());
  write_collapse_survey(directory / "b.counts", {3, 4}, some_counts());
  EXPECT_EQ(read_collapse_survey(directory / "b.counts").content, found.content);
}

TEST(CollapseSurveyFile, DamageIsFound) {
  const TempDirectory directory;
  const auto path = directory / "a.counts";
  write_collapse_survey(path, {1, 2}, some_counts());
  expect_damage_is_found(path, [&] { read_collapse_survey(path); });
}

TEST(CollapseSurveyFile, CountsThatCannotBeAreDamage) {
  const TempDirectory directory;
  const auto path = directory / "a.counts";
  CollapseSurvey grows = some_counts(), more_held = some_counts();
  grows.left = {50, 80, 50};
  more_held.held = 11;
  for (const CollapseSurvey& survey : {grows, more_held}) {
    write_collapse_survey(path, {1, 2}, survey);
    EXPECT_THROW(read_collapse_survey(path), DamagedArtifact);
  }
}

TEST(ToleranceFile, ReadsBackAndDamageIsFound) {
  const TempDirectory directory;
  const auto path = directory / "tolerance";
  write_tolerance_artifact(path, {{1, 2}, chosen, {3, 4}});
  const ToleranceArtifact found = read_tolerance_artifact(path);
  EXPECT_EQ(found.key, (Hash128{1, 2}));
  EXPECT_EQ(found.sources, (Hash128{3, 4}));
  EXPECT_EQ(found.chosen, chosen);
  expect_damage_is_found(path, [&] { read_tolerance_artifact(path); });
}

TEST(ToleranceFile, OneBelowZeroIsDamage) {
  const TempDirectory directory;
  ChosenTolerance below = chosen;
  below.tolerance = -1;
  write_tolerance_artifact(directory / "tolerance", {{1, 2}, below, {}});
  EXPECT_THROW(read_tolerance_artifact(directory / "tolerance"), DamagedArtifact);
}

}  // namespace
}  // namespace voxweld
