#include "pipeline/report/manifest_tables.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace voxweld {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

Manifest manifest_with(json error, json refine = nullptr) {
  Manifest manifest;
  manifest.error = std::make_unique<json>(std::move(error));
  if (!refine.is_null()) manifest.refine = std::make_unique<json>(std::move(refine));
  manifest.counts.leaves = {1000, 500};
  manifest.merged.emplace();
  return manifest;
}

json usual_error() {
  return {{"metric", "rms"},
          {"tolerance", 0.1},
          {"reached", 0.05},
          {"levels", {0.4, 0.05}},
          {"unit", "mm"}};
}

TEST(ManifestTables, LevelsSayHowMuchOfTheToleranceIsUsed) {
  const std::string html = level_table(manifest_with(usual_error()));
  EXPECT_THAT(html, HasSubstr("<th scope=\"row\">2</th><td class=\"num\">500</td>"));
  EXPECT_THAT(html, HasSubstr("width:50.0%"));  // half of the cells, half of the tolerance
  EXPECT_THAT(html,
              HasSubstr("0.4 mm</td><td class=\"bar\"><span class=\"faint\" style=\"width:100.0%"));
  EXPECT_EQ(level_table(Manifest()), "");
}

TEST(ManifestTables, StagesHaveBarsOfTheLongest) {
  Manifest manifest;
  EXPECT_EQ(stage_table(manifest), "");
  manifest.stages = std::make_unique<json>(json::array());
  EXPECT_EQ(stage_table(manifest), "");
  for (const auto& [name, seconds] : {std::pair{"build", 4.0}, std::pair{"<merge>", 1.0}})
    manifest.stages->push_back({{"stage", name},
                                {"units", 12345},
                                {"ran", 7},
                                {"seconds", seconds},
                                {"peak_resident_bytes", 1048576}});
  const std::string html = stage_table(manifest);
  EXPECT_THAT(html, HasSubstr("&lt;merge&gt;"));
  EXPECT_THAT(html, HasSubstr(">12,345</td><td class=\"num\">7</td>"));
  EXPECT_THAT(html, HasSubstr("width:25.0%"));
  EXPECT_THAT(html, HasSubstr("1.0 MiB"));
  for (json& stage : *manifest.stages) stage["ran"] = 0;
  EXPECT_THAT(stage_table(manifest), ::testing::Not(HasSubstr("width:25.0%")));  // looks alone
}

TEST(ManifestTables, NotesTellWhatIsNotAsItShouldBe) {
  const Config config;
  EXPECT_THAT(notes_of(manifest_with(usual_error(), {{"intersecting_left", 0}}), config),
              IsEmpty());
  Manifest manifest =
      manifest_with(usual_error(), {{"intersecting_left", 12}, {"target", {{"reached", false}}}});
  manifest.open_border = true;
  manifest.merged.reset();
  const auto notes = notes_of(manifest, config);
  ASSERT_EQ(notes.size(), 4u);
  EXPECT_EQ(notes[0], "12 pairs of triangles still cut each other.");
  EXPECT_THAT(notes[1], HasSubstr("could not be reached"));
  EXPECT_THAT(notes[2], HasSubstr("no merged mesh"));
  EXPECT_THAT(notes[3], HasSubstr("open"));
  Config without;
  without.output.merged = OutputConfig::Merged::never;
  EXPECT_EQ(notes_of(manifest, without).size(), 3u);
}

}  // namespace
}  // namespace voxweld
