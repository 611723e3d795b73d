// What the page is told of a run and of a file.
#include "pipeline/view/scene.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "storage/support/error.h"
#include "tests/pipeline/cli/workplace.h"
#include "tests/pipeline/output/output_directory.h"

namespace voxweld::testing {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using ::testing::HasSubstr;

json scene_of(const fs::path& path) {
  return json::parse(scene_text(ServedFiles(path)));
}

std::string refusal(const fs::path& path) {
  try {
    check_viewable(ServedFiles(path));
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

class Scene : public ::testing::Test {
 protected:
  Scene() {
    output_.tiles = cut_into_tiles(make_torus({.around = 12, .across = 8}, small_lattice()), 4);
  }
  fs::path folder() const { return place_.path() / "scan.mesh"; }
  json written() const {
    output_.write(folder());
    return scene_of(folder());
  }

  const TempDirectory place_;
  OutputDirectory output_;
};

TEST_F(Scene, TellsTheRun) {
  output_.restate = [](Manifest& manifest) {
    manifest.frame.spacing = {0.5, 1, 2};
    manifest.frame.origin = {10, 20, 30};
    manifest.frame.direction = {Vec3{0, 1, 0}, Vec3{1, 0, 0}, Vec3{0, 0, 1}};
    manifest.frame.space = "LPS";
    manifest.error = std::make_unique<json>(json{{"tolerance", 0.25}});
  };
  const json scene = written();
  EXPECT_EQ(scene["format"], "voxweld-scene");
  EXPECT_EQ(scene["kind"], "run");
  EXPECT_EQ(scene["name"], "scan.mesh");
  EXPECT_EQ(scene["unit"], "mm");
  EXPECT_EQ(scene["metres_per_unit"], 1e-3);
  EXPECT_EQ(scene["frame"]["size"], json({40, 40, 40}));
  EXPECT_EQ(scene["frame"]["origin"], json({10, 20, 30}));
  EXPECT_EQ(scene["frame"]["direction"], json({{0, 1, 0}, {1, 0, 0}, {0, 0, 1}}));
  EXPECT_EQ(scene["frame"]["space"], "LPS");
  EXPECT_EQ(scene["bounds"]["lo"], json({0, 0, 0}));
  EXPECT_EQ(scene["bounds"]["hi"], json({19.5, 39, 78}));
  EXPECT_EQ(scene["border"], "closed");
  EXPECT_EQ(scene["labels_mode"], "off");
  EXPECT_EQ(scene["error"]["tolerance"], 0.25);
  EXPECT_EQ(scene["counts"]["tiles"], output_.tiles.size());
  EXPECT_EQ(scene["counts"]["triangles"], 2 * 12 * 8);
  EXPECT_TRUE(scene["labels"].empty());
  EXPECT_FALSE(scene.contains("tileset"));
  EXPECT_FALSE(scene.contains("report"));
}

TEST_F(Scene, ListsTilesWithTheirBoxes) {
  output_.tiles.resize(1);
  output_.tiles[0].tile = CellKey{4, {1, 0, 2}};
  output_.restate = [](Manifest& manifest) { manifest.frame.first = {100, 0, 0}; };
  const json scene = written(), tile = scene["tiles"].at(0);
  EXPECT_EQ(tile["level"], 4);
  EXPECT_EQ(tile["at"], json({1, 0, 2}));
  EXPECT_EQ(tile["triangles"], output_.tiles[0].triangles.size());
  EXPECT_EQ(tile["vertices"], output_.tiles[0].positions.size());
  EXPECT_FALSE(tile.contains("label"));
  // Cells of 16 samples that begin at -1; the last one ends with the volume.
  EXPECT_EQ(tile["box"]["lo"], json({115, -1, 31}));
  EXPECT_EQ(tile["box"]["hi"], json({131, 15, 40}));
  const json file = tile["files"].at(0);
  EXPECT_EQ(file["format"], "drc");
  EXPECT_EQ(file["path"], "tiles/0.drc");
  EXPECT_EQ(file["bytes"], fs::file_size(folder() / "tiles/0.drc"));
  EXPECT_EQ(tile["files"].size(), 2);
}

TEST_F(Scene, ListsTheWholeMesh) {
  const json merged = written()["merged"];
  ASSERT_EQ(merged.size(), 2);
  EXPECT_EQ(merged.at(0)["path"], "mesh.drc");
  EXPECT_EQ(merged.at(1)["format"], "glb");
  output_.merged = false;
  EXPECT_TRUE(written()["merged"].empty());
}

TEST_F(Scene, ListsLabels) {
  output_.merged = false;
  output_.tiles = {make_cube(small_lattice(), {1, 1, 1}, 4),
                   make_cube(small_lattice(), {9, 9, 9}, 4)};
  output_.labels = {3, 18446744073709551614u};
  output_.relabel = [](LabelRecord& record) {
    if (record.label != 3) return;
    record.name = "bone \"<b>\" \xC3\xA9";
    record.color = {255, 0, 51};
  };
  const json scene = written();
  const json& labels = scene["labels"];
  EXPECT_EQ(scene["labels_mode"], "each");
  ASSERT_EQ(labels.size(), 2);
  EXPECT_EQ(labels.at(0)["label"], "3");
  EXPECT_EQ(labels.at(0)["name"], "bone \"<b>\" \xC3\xA9");
  EXPECT_EQ(labels.at(0)["colour"].at(0), 1.0);
  EXPECT_NEAR(labels.at(0)["colour"].at(2).get<double>(), 0.0331, 1e-4) << "linear";
  EXPECT_EQ(labels.at(0)["triangles"], 12);
  EXPECT_EQ(labels.at(0)["bounds"]["hi"], json({5, 5, 5}));
  EXPECT_EQ(labels.at(1)["label"], "18446744073709551614") << "no number of JavaScript";
  EXPECT_EQ(labels.at(1)["name"], "");
  EXPECT_EQ(labels.at(1)["colour"].size(), 3);
  EXPECT_EQ(scene["tiles"].at(0)["label"], "3");
}

TEST_F(Scene, TellsOfTilesetAndReportWhereTheyAre) {
  output_.write(folder());
  write_bytes((folder() / "tileset.json").string(), "{}");
  write_bytes((folder() / "report.html").string(), "");
  const json scene = scene_of(folder());
  EXPECT_EQ(scene["tileset"], "tileset.json");
  EXPECT_EQ(scene["report"], "report.html");
}

TEST_F(Scene, TellsNoPathsOfThisMachine) {
  output_.restate = [](Manifest& manifest) {
    manifest.input = std::make_unique<json>(json{{"path", "/home/somebody/scan.nrrd"}});
    manifest.made_by =
        std::make_unique<json>(json{{"host", "somewhere"}, {"time", "2026-01-01T00:00:00Z"}});
  };
  output_.write(folder());
  const std::string text = scene_text(ServedFiles(folder()));
  for (const std::string& word :
       {std::string("somebody"), std::string("somewhere"), folder().parent_path().string()})
    EXPECT_THAT(text, ::testing::Not(HasSubstr(word)));
  EXPECT_THAT(text, HasSubstr("2026-01-01"));
}

TEST_F(Scene, OfOneFile) {
  output_.write(folder());
  const json scene = scene_of(folder() / "mesh.glb");
  EXPECT_EQ(scene["kind"], "file");
  EXPECT_EQ(scene["name"], "mesh.glb");
  EXPECT_EQ(scene["file"]["format"], "glb");
  EXPECT_EQ(scene["file"]["path"], "mesh.glb");
  EXPECT_EQ(scene["file"]["bytes"], fs::file_size(folder() / "mesh.glb"));
}

TEST_F(Scene, RefusesWhatIsNoMesh) {
  output_.write(folder());
  EXPECT_EQ(refusal(folder()), "");
  EXPECT_EQ(refusal(folder() / "mesh.drc"), "");
  for (const char* name : {"a.ply", "a.stl", "a.obj", "a.plain.glb", "a.glb"}) {
    write_bytes((place_.path() / name).string(), "");
    EXPECT_EQ(refusal(place_.path() / name), "") << name;
  }
  EXPECT_THAT(refusal(folder() / "manifest.json"),
              HasSubstr("not a mesh file that can be shown; expected .drc, "));
  EXPECT_THAT(refusal(folder() / "tiles"), HasSubstr("it has no manifest.json"));
  EXPECT_THAT(refusal(place_.path()), HasSubstr("outputs in it: scan.mesh"));
}

}  // namespace
}  // namespace voxweld::testing
