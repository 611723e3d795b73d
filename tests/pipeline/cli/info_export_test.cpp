// What info says of exports for Neuroglancer.
#include <fmt/format.h>

#include "tests/pipeline/cli/workplace.h"

namespace voxweld::testing {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using Words = std::vector<std::string>;

std::uint64_t bytes_below(const std::string& folder) {
  std::uint64_t bytes = 0;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file()) bytes += entry.file_size();
  return bytes;
}

void run_labels(const Workplace& place) {
  place.run(
      {"phantom", "labels", "--size", "24", "--type", "uint16", "-o", place.at("cells.nrrd")});
  place.run({"init", place.at("cells.nrrd"), "--labels", "-o", place.at("cells.toml")});
  place.run({"run", place.at("cells.toml"), "--set", "output.report=false"});
}

nlohmann::json export_of(const Workplace& place, const std::string& mesh, const Words& how,
                         Words more = {}) {
  const std::string folder = place.at("x.ng");
  place.run(Words{"export", place.at(mesh), "--neuroglancer", "--force", "-o", folder} + how);
  return place.info(folder, std::move(more));
}

TEST(InfoOfExport, TellsObjectsLevelsAndBytes) {
  const Workplace place;
  place.run({"phantom", "gyroid", "--size", "48", "-o", place.at("v.nrrd")});
  write_bytes(place.at("v.toml"),
              "[input]\npath = \"v.nrrd\"\n[surface]\nisovalue = 32767.5\ninside = \"below\"\n"
              "[output]\nlevels = \"auto\"\ntile_vertices = 1024\nreport = false\n");
  place.run({"run", place.at("v.toml")});
  const auto info = export_of(place, "v.mesh", {}, {"--verbose", "--check"});
  EXPECT_EQ(info.at("kind"), "neuroglancer_export");
  EXPECT_EQ(info.at("bytes"), bytes_below(place.at("x.ng")));
  EXPECT_EQ(info.at("objects"), 1);
  EXPECT_EQ(info.at("sharded"), false);
  ASSERT_GT(info.at("levels").size(), 1U);
  std::uint64_t bytes = 0, fragments = 0;
  for (const auto& level : info.at("levels")) {
    EXPECT_EQ(level.at("objects"), 1);
    bytes += level.at("bytes").get<std::uint64_t>();
    fragments += level.at("fragments").get<std::uint64_t>();
  }
  EXPECT_EQ(bytes, fs::file_size(place.at("x.ng/1")));
  EXPECT_EQ(info.at("object_list").at(0).at("bytes"), bytes);
  EXPECT_EQ(info.at("object_list").at(0).at("fragments"), fragments);
  EXPECT_TRUE(info.at("check").at("damaged").empty());
  // The file that makes it one, and the text for people.
  EXPECT_EQ(place.info(place.at("x.ng/info")).at("kind"), "neuroglancer_export");
  EXPECT_THAT(place.run({"info", place.at("x.ng")}).out, HasSubstr("neuroglancer_export"));
}

TEST(InfoOfExport, OfManyObjectsInAllThreeForms) {
  const Workplace place;
  run_labels(place);
  const auto files = export_of(place, "cells.mesh", {});
  const auto sharded = export_of(place, "cells.mesh", {"--sharded"});
  const auto legacy = export_of(place, "cells.mesh", {"--legacy"}, {"--verbose"});
  EXPECT_GT(files.at("objects"), 3);
  EXPECT_EQ(sharded.at("objects"), files.at("objects"));
  EXPECT_EQ(sharded.at("levels"), files.at("levels"));
  EXPECT_EQ(sharded.at("sharded"), true);
  EXPECT_EQ(legacy.at("objects"), files.at("objects"));
  EXPECT_EQ(legacy.at("format"), "legacy");
  EXPECT_EQ(legacy.at("object_list").size(), legacy.at("objects"));
}

TEST(InfoOfExport, FindsDamageAndKnowsStrangers) {
  const Workplace place;
  run_labels(place);
  export_of(place, "cells.mesh", {});
  const std::string index = first_file(place.at("x.ng"), ".index");
  const std::string data = read_bytes(index.substr(0, index.size() - std::string(".index").size()));
  write_bytes(index.substr(0, index.size() - std::string(".index").size()),
              data.substr(0, data.size() / 2));
  const ProgramResult checked = run_voxweld({"info", place.at("x.ng"), "--check"});
  EXPECT_EQ(checked.exit_code, 1);
  EXPECT_THAT(checked.out, HasSubstr("the fragments of object"));
  // A mesh of another program, and a volume.
  write_bytes(place.at("x.ng/info"), R"({"@type": "neuroglancer_multilod_draco"})");
  expect_refused({"info", place.at("x.ng")}, {"was not written by voxweld"});
  write_bytes(place.at("x.ng/info"), R"({"type": "image", "scales": []})");
  expect_refused({"info", place.at("x.ng")}, {"a directory of an unknown kind"});
}

}  // namespace
}  // namespace voxweld::testing
