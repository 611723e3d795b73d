// What `info` says of files that are missing, unknown, cut short or changed.
#include <algorithm>

#include "tests/pipeline/cli/workplace.h"

namespace voxweld::testing {
namespace {

using ::testing::HasSubstr;

class InfoOfDamage : public ::testing::Test {
 protected:
  // Changes one byte of the file, `back` bytes before its end.
  static void flip(const std::string& path, std::size_t at) {
    std::string bytes = read_bytes(path);
    bytes.at(at) = static_cast<char>(bytes.at(at) ^ 0x10);
    write_bytes(path, bytes);
  }
  // `info --check` finds damage in just this file.
  static void expect_found(const std::string& path, const std::string& file) {
    const ProgramResult result = run_voxweld({"info", path, "--check", "--json"});
    EXPECT_EQ(result.exit_code, 1) << result.err;
    const auto document = nlohmann::json::parse(result.out, nullptr, false);
    ASSERT_TRUE(document.is_object());
    const auto& damaged = document.at("check").at("damaged");
    ASSERT_EQ(damaged.size(), 1u) << damaged;
    EXPECT_EQ(damaged[0].at("path"), file);
    EXPECT_NE(damaged[0].at("what"), "");
  }

  Workplace place;
};

TEST_F(InfoOfDamage, NothingThere) {
  expect_refused({"info", place.at("nothing")}, {"nothing", "no such file"});
}

TEST_F(InfoOfDamage, UnknownFilesGetTheListOfKnownOnes) {
  write_bytes(place.at("notes.txt"), "hello");
  write_bytes(place.at("empty"), "");
  for (const char* name : {"notes.txt", "empty"})
    expect_refused({"info", place.at(name)},
                   {name, "unknown", "nrrd", ".drc", "all that a run writes"});
  std::filesystem::create_directories(place.at("folder"));
  expect_refused({"info", place.at("folder")}, {"folder", "unknown", "no images", "nifti"});
}

TEST_F(InfoOfDamage, StacksThatDoNotFitTogetherSayWhy) {
  std::filesystem::create_directories(place.at("slices"));
  write_bytes(place.at("slices/1.tif"), "");
  write_bytes(place.at("slices/3.tif"), "");
  const ProgramResult result = run_voxweld({"info", place.at("slices")});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr("slices"));
  EXPECT_THAT(result.err, ::testing::Not(HasSubstr("info knows")));
}

TEST_F(InfoOfDamage, TruncatedArtifactsAreNamed) {
  place.run_scene({"work.copy=true"});
  for (const char* ending : {".octree", "top.tree", ".tile", ".record", ".shard"}) {
    const std::string path = first_file(place.at("scene.work"), ending);
    const std::string whole = read_bytes(path);
    for (const std::size_t length : {std::size_t{0}, std::size_t{7}, std::size_t{40},
                                     std::size_t{70}, whole.size() / 2, whole.size() - 1}) {
      write_bytes(path, whole.substr(0, length));
      expect_refused({"info", path}, {path, "run again"});
    }
    write_bytes(path, whole);
    place.info(path);
  }
}

TEST_F(InfoOfDamage, TruncatedMeshesManifestsAndConfigsAreNamed) {
  place.run_scene({});
  for (const char* name : {"scene.mesh/mesh.drc", "scene.mesh/mesh.glb", "scene.mesh/manifest.json",
                           "scene.mesh/tiles.jsonl", "scene.toml"}) {
    const std::string path = place.at(name);
    const std::string whole = read_bytes(path);
    // On a line of its own, for the half of a config may end in a comment.
    write_bytes(path, whole.substr(0, whole.size() / 2) + "\n[");
    expect_refused({"info", path}, {path});
    write_bytes(path, whole);
  }
}

TEST_F(InfoOfDamage, CheckFindsOneChangedByte) {
  place.run_scene({"work.copy=true"});
  const std::string work = place.at("scene.work");
  for (const char* ending : {".octree", "top.tree", ".tile", ".record", "/c/0/0/0"}) {
    const std::string path = first_file(work, ending);
    const std::string whole = read_bytes(path);
    flip(path, std::min<std::size_t>(whole.size() - 1, 80));
    expect_found(work, path);
    write_bytes(path, whole);
  }
  place.info(work, {"--check"});
}

TEST_F(InfoOfDamage, CheckComparesTheOutputWithItsManifest) {
  place.run_scene({});
  const std::string mesh = place.at("scene.mesh/mesh.glb");
  flip(mesh, 200);
  expect_found(place.at("scene.mesh"), mesh);
  std::filesystem::remove(mesh);
  expect_found(place.at("scene.mesh"), mesh);
}

TEST_F(InfoOfDamage, CheckFindsShardsThatAreNotTheirRecords) {
  const std::string store = place.phantom("scene.zarr", 40);
  flip(place.at("scene.zarr/c/0/0/0"), 30);
  expect_found(store, place.at("scene.zarr/c/0/0/0"));
  const std::string record = first_file(store, ".shard");
  flip(place.at("scene.zarr/c/0/0/0"), 30);
  flip(record, 90);
  expect_found(store, record);
}

}  // namespace
}  // namespace voxweld::testing
