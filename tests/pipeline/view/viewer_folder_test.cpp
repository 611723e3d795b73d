// `voxweld view --export`: which files the folder has, and what it refuses.
#include <nlohmann/json.hpp>

#include "pipeline/view/page_files.h"
#include "storage/manifest/manifest.h"
#include "tests/pipeline/cli/workplace.h"

namespace voxweld::testing {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::Each;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::Not;

namespace fs = std::filesystem;

class ViewerFolder : public ::testing::Test {
 protected:
  void SetUp() override {
    if (page_files().empty()) GTEST_SKIP() << "built without the viewer's page";
  }
  ProgramResult write(const Arguments& more = {}) const {
    return run_voxweld(Arguments{"view", place_.at("scene.mesh"), "--export", place_.at("page")} +
                       more);
  }
  void expect_written(const Arguments& more = {}) const {
    const ProgramResult result = write(more);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_THAT(result.out, HasSubstr("next: put the folder on any web server"));
  }
  void expect_no_folder(const std::string& why, const Arguments& more = {}) const {
    const ProgramResult result = write(more);
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_THAT(result.err, HasSubstr(why));
  }
  std::vector<std::string> data() const {
    std::vector<std::string> names;
    for (const auto& entry : fs::recursive_directory_iterator(place_.at("page/data")))
      if (entry.is_regular_file())
        names.push_back(fs::relative(entry.path(), place_.at("page/data")).string());
    return names;
  }
  nlohmann::json scene() const {
    return nlohmann::json::parse(read_bytes(place_.at("page/api/scene")));
  }

  Workplace place_;
};

TEST_F(ViewerFolder, HasThePageAndTheSmallestFormatOfTheTiles) {
  place_.run_scene(
      {"output.formats="
       "[\"drc\", \"glb-plain\"]"});
  expect_written();
  for (const PageFile& file : page_files())
    EXPECT_TRUE(read_bytes(place_.at("page/" + std::string(file.name))) == file.bytes) << file.name;
  EXPECT_FALSE(scene().contains("report"));
  EXPECT_THAT(data(), Each(EndsWith(".drc")));
  std::size_t files = 0;
  const nlohmann::json written = scene();
  for (const auto& tile : written.at("tiles"))
    for (const auto& file : tile.at("files")) {
      ++files;
      const std::string path = file.at("path");
      EXPECT_EQ(read_bytes(place_.at("page/data/" + path)),
                read_bytes(place_.at("scene.mesh/" + path)));
    }
  EXPECT_EQ(files, data().size());
  EXPECT_GT(files, 0u);
}

TEST_F(ViewerFolder, HasATilesetWithItsTilesOfAllLevels) {
  place_.run_scene(
      {"output.levels="
       "2",
       "output.formats="
       "[\"drc\", \"glb\"]"});
  expect_written();
  EXPECT_THAT(data(), AllOf(Contains("tileset.json"), Contains(HasSubstr("levels/1/")),
                            Contains(HasSubstr("tiles/")), Not(Contains(EndsWith(".drc")))));
  EXPECT_EQ(scene().at("tileset"), "tileset.json");
}

TEST_F(ViewerFolder, OfOneFileHasThatFile) {
  place_.run_scene({});
  const ProgramResult result =
      run_voxweld({"view", place_.at("scene.mesh/mesh.drc"), "--export", place_.at("page")});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(data(), std::vector<std::string>{"mesh.drc"});
  const nlohmann::json info = place_.info(place_.at("page"));
  EXPECT_EQ(info.at("kind"), "viewer_folder");
  EXPECT_EQ(info.at("shown"), "mesh.drc");
  const ProgramResult again = run_voxweld({"view", place_.at("page")});
  EXPECT_EQ(again.exit_code, 2);
  EXPECT_THAT(again.err, HasSubstr("put it on a web server"));
}

TEST_F(ViewerFolder, IsNotWrittenOverWhatIsNotItsOwn) {
  place_.run_scene({});
  expect_written();
  expect_no_folder("is not empty; use --force to write over an earlier export");
  expect_written({"--force"});
  write_bytes(place_.at("page/notes.txt"), "mine");
  expect_no_folder(
      "has notes.txt, which no export has written; name a new or an empty folder with "
      "--export",
      {"--force"});
  // No advice to force what would be refused then.
  expect_no_folder("has notes.txt");
  EXPECT_TRUE(fs::exists(place_.at("page/api/scene")));
  const ProgramResult inside =
      run_voxweld({"view", place_.at("scene.mesh"), "--export", place_.at("scene.mesh/page")});
  EXPECT_EQ(inside.exit_code, 2);
  EXPECT_THAT(inside.err, HasSubstr("lies in the output directory"));
  const ProgramResult of_file = run_voxweld(
      {"view", place_.at("scene.mesh/mesh.drc"), "--export", place_.at("scene.mesh/tiles/page")});
  EXPECT_EQ(of_file.exit_code, 2);
  EXPECT_THAT(of_file.err, HasSubstr("lies in the output directory"));
  const ProgramResult nowhere = run_voxweld({"view", place_.at("scene.mesh"), "--export", ""});
  EXPECT_EQ(nowhere.exit_code, 2);
  EXPECT_THAT(nowhere.err, HasSubstr("expected a folder, found an empty name"));
}

TEST_F(ViewerFolder, SaysWhichFileIsNotAsListed) {
  place_.run_scene(
      {"output.formats="
       "[\"drc\"]"});
  std::string tile;
  for (const auto& entry : fs::recursive_directory_iterator(place_.at("scene.mesh/tiles")))
    if (entry.is_regular_file()) tile = entry.path();
  const std::string bytes = read_bytes(tile);
  write_bytes(tile, bytes.substr(1));
  expect_no_folder("the output's lists say");
  EXPECT_FALSE(fs::exists(place_.at("page/api/scene")));
  fs::remove(tile);
  expect_no_folder("is missing, or no file", {"--force"});
}

TEST_F(ViewerFolder, GoesWithNoServer) {
  place_.run_scene({});
  expect_no_folder("--port", {"--port", "8000"});
  const ProgramResult result = run_voxweld({"view", place_.at("scene.mesh"), "--force"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr("--export"));
}

}  // namespace
}  // namespace voxweld::testing
