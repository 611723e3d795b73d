// What a run knows of the files that earlier ones have left in its output directory, also where
// what lists them is damaged.
#include <gmock/gmock.h>

#include <fstream>
#include <set>

#include "pipeline/encode/output_files.h"
#include "storage/manifest/manifest.h"
#include "storage/support/file_io.h"
#include "tests/pipeline/encode/encoded_scene.h"

namespace voxweld {
namespace {

namespace fs = std::filesystem;
using ::testing::Contains;
using ::testing::Not;
using Names = std::set<std::string>;

class EarlierMeshes : public ::testing::Test {
 protected:
  EarlierMeshes() {
    scene.encode(job);
    for (const std::string& name : known())
      if (name != tiles_name) meshes.insert(name);
    EXPECT_GT(meshes.size(), 4u);
    std::ofstream(output / "tiles" / "notes.txt") << "not ours";
    std::ofstream(output / "tiles" / "part.glb") << "not ours";
  }

  Names known() const {
    FileNames names(job.folder);
    add_files_of_earlier_runs(output, names);
    Names all;
    names.each([&](const std::string& name) { all.insert(name); });
    return all;
  }
  void replace_in(const char* file, const std::string& from, const std::string& to) const {
    std::string text = read_text_file(output / file);
    ASSERT_NE(text.find(from), std::string::npos);
    text.replace(text.find(from), from.size(), to);
    write_whole_file(output / file, as_bytes(text), Durability::rename_only);
  }
  void expect_all_meshes() const {
    const Names names = known();
    for (const std::string& mesh : meshes) EXPECT_THAT(names, Contains(mesh));
    EXPECT_THAT(names, Not(Contains("tiles/notes.txt")));
    EXPECT_THAT(names, Not(Contains("tiles/part.glb")));
  }

  testing::EncodedScene scene{{"output.tile_vertices=1024", "simplify.enabled=false"}};
  const EncodeJob job = scene.job("earlier");
  const fs::path output = job.output;
  Names meshes;
};

TEST_F(EarlierMeshes, AreKnownByTheLists) {
  expect_all_meshes();
}

TEST_F(EarlierMeshes, AreKnownWhereTheListIsDamaged) {
  replace_in(tiles_name, "tiles/", "tilez/");
  expect_all_meshes();
}

TEST_F(EarlierMeshes, AreKnownWhereTheListIsCut) {
  fs::resize_file(output / tiles_name, 100);
  expect_all_meshes();
}

TEST_F(EarlierMeshes, AreKnownWhereTheListIsGone) {
  fs::remove(output / tiles_name);
  expect_all_meshes();
}

TEST_F(EarlierMeshes, AreKnownWhereTheManifestIsDamaged) {
  replace_in(manifest_name, "\"files\"", "\"fules\"");
  expect_all_meshes();
}

TEST_F(EarlierMeshes, OfAManifestThatIsNotOursAreNone) {
  write_whole_file(output / manifest_name, as_bytes(std::string("{\"name\": \"a web app\"}")),
                   Durability::rename_only);
  EXPECT_EQ(known(), Names());
}

}  // namespace
}  // namespace voxweld
