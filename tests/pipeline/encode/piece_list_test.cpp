// tiles.pvtp: which tiles it lists, and of what type it says their arrays are.
#include "pipeline/encode/piece_list.h"

#include <gmock/gmock.h>

#include "pipeline/output/verify.h"
#include "storage/manifest/manifest.h"
#include "storage/support/file_io.h"
#include "tests/pipeline/encode/encoded_scene.h"

namespace voxweld {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

std::string text_of(const std::filesystem::path& path) {
  const std::vector<std::byte> bytes = read_whole_file(path);
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

class PieceListTest : public ::testing::Test {
 protected:
  static AssetRecord tile(const std::string& stem, const std::vector<Material>& labels = {}) {
    AssetRecord record;
    record.files = {{stem + ".drc", "drc", {}, 1, {}}, {stem + ".vtp", "vtp", {}, 1, {}}};
    for (const Material label : labels) {
      LabelAsset part;
      part.label = label;
      record.labels.push_back(part);
    }
    return record;
  }
  std::string written() const { return text_of(directory_ / pieces_name); }

  testing::TempDirectory place_;
  const std::filesystem::path directory_ = place_ / ".";
};

TEST_F(PieceListTest, ListsEachTileThatHasAFile) {
  PieceList list(directory_, {.normals = true, .between_labels = false});
  list.add(tile("tiles/0-0-0-0"));
  list.add(AssetRecord{});  // a tile without triangles
  list.add(tile("tiles/0-1-0-0"));
  const auto record = list.finish();
  ASSERT_TRUE(record);
  EXPECT_EQ(record->path, "tiles.pvtp");
  EXPECT_EQ(record->role, "pieces");
  EXPECT_THAT(written(), HasSubstr("<Piece Source=\"tiles/0-0-0-0.vtp\"/>\n"
                                   "<Piece Source=\"tiles/0-1-0-0.vtp\"/>\n"));
  EXPECT_THAT(written(), HasSubstr("Name=\"Normals\""));
  EXPECT_THAT(written(), Not(HasSubstr("PCellData")));
}

TEST_F(PieceListTest, IsNotThereWithoutSuchFiles) {
  PieceList list(directory_, {});
  list.add(AssetRecord{});
  EXPECT_FALSE(list.finish());
  EXPECT_FALSE(std::filesystem::exists(directory_ / pieces_name));
}

TEST_F(PieceListTest, SaysHowManyBitsLabelsHave) {
  const Material large = Material{1} << 40;
  for (const auto& [labels, type] :
       {std::pair{std::vector<Material>{3, 5}, "Int32"}, {std::vector<Material>{large}, "Int64"}}) {
    PieceList list(directory_, {.normals = true, .between_labels = true});
    list.add(tile("tiles/0-0-0-0", labels));
    ASSERT_TRUE(list.finish());
    EXPECT_THAT(written(),
                HasSubstr(std::string("<PDataArray type=\"") + type + "\" Name=\"label\"/>"));
    EXPECT_THAT(written(), Not(HasSubstr("Normals")));
  }
}

// VTK takes the bytes of a piece for the list's type, whatever its own is.
TEST_F(PieceListTest, IsNotThereWhereTilesDiffer) {
  PieceList list(directory_, {.normals = false, .between_labels = true});
  list.add(tile("tiles/0-0-0-0", {3}));
  list.add(tile("tiles/0-1-0-0", {3, Material{1} << 40}));
  EXPECT_FALSE(list.finish());
  EXPECT_FALSE(std::filesystem::exists(directory_ / pieces_name));
}

TEST(PieceListOfARun, IsListedAndGoesWithItsFormat) {
  testing::EncodedScene scene({"output.tile_vertices=1024", "simplify.enabled=false"});
  EncodeJob job = scene.job("run");
  const auto encode = [&](const std::vector<std::string>& names) {
    scene.context().config.output.formats = names;
    job.formats = writers_named(mesh_writers(), names);
    job.key.lo ^= names.size();
    scene.encode(job);
  };
  encode({"drc", "vtp"});
  const VerifyReport report = verify_output(job.output);
  EXPECT_TRUE(report.good()) << to_text(report);
  const Manifest manifest = read_manifest(job.output / manifest_name);
  EXPECT_EQ(std::ranges::count(manifest.files, std::string("pieces"), &FileRecord::role), 1);
  const std::string text = text_of(job.output / pieces_name);
  std::size_t pieces = 0;
  for (std::size_t at = 0; (at = text.find("<Piece ", at)) != std::string::npos; ++at) ++pieces;
  EXPECT_EQ(pieces, manifest.counts.tiles);
  EXPECT_GT(pieces, 1u);
  encode({"drc"});
  EXPECT_FALSE(std::filesystem::exists(job.output / pieces_name));
}

}  // namespace
}  // namespace voxweld
