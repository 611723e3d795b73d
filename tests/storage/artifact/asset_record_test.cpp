#include "storage/artifact/asset_record.h"

#include <gtest/gtest.h>

#include <chrono>

#include "storage/support/file_io.h"
#include "tests/support/temp_directory.h"

namespace voxweld {
namespace {

namespace fs = std::filesystem;

constexpr Hash128 record_key{1, 2};

class AssetRecordTest : public ::testing::Test {
 protected:
  void SetUp() override {
    AssetRecord record;
    record.key = record_key;
    AssetFile file(output(), "tile.drc");
    file.append(as_bytes(std::string("12")));
    file.append(as_bytes(std::string("345")));
    record.files.push_back(file.finish("drc"));
    write_asset_record(path(), record, output());
  }
  fs::path output() const { return directory_ / "mesh"; }
  fs::path path() const { return directory_ / "tile.record"; }
  fs::path file() const { return output() / "tile.drc"; }
  bool is_current() const { return asset_is_current(path(), record_key, output()); }
  Hash128 stamp() const { return read_asset_record(path())->files_stamp; }
  void write_later(const std::string& text) const {
    write_whole_file(file(), as_bytes(text), Durability::rename_only);
    fs::last_write_time(file(), fs::last_write_time(file()) + std::chrono::seconds(2));
  }

 private:
  const testing::TempDirectory directory_;
};

TEST_F(AssetRecordTest, IsOfItsKey) {
  EXPECT_TRUE(is_current());
  EXPECT_FALSE(asset_is_current(path(), {1, 3}, output()));
}

TEST_F(AssetRecordTest, SameBytesOfAnotherTimeAreCurrentAndNotReadAgain) {
  const Hash128 before = stamp();
  write_later("12345");
  EXPECT_TRUE(is_current());
  EXPECT_NE(stamp(), before);
  const auto written = fs::last_write_time(path());
  EXPECT_TRUE(is_current());
  EXPECT_EQ(fs::last_write_time(path()), written);
}

TEST_F(AssetRecordTest, LabelsComeBackAsTheyWere) {
  AssetRecord record = *read_asset_record(path());
  LabelAsset asset;
  asset.label = 0xffff'ffff'ffff'fffeU;
  asset.tile = {3, {1, 0, 7}};
  asset.octree_vertices = 5;
  asset.vertices = 6;
  asset.triangles = 7;
  asset.quads = 8;
  asset.polygon_triangles = 9;
  asset.files = 1;
  asset.measure = {-(Wide{1} << 100) + 3, 2.5, {-1, 2, -3}, {4, 5, 6}, false};
  record.labels = {asset, LabelAsset{}};
  write_asset_record(path(), record, output());
  const AssetRecord read = *read_asset_record(path());
  ASSERT_EQ(read.labels.size(), 2u);
  const LabelAsset& back = read.labels[0];
  EXPECT_EQ(back.label, asset.label);
  EXPECT_EQ(back.tile, asset.tile);
  EXPECT_EQ(back.octree_vertices, 5u);
  EXPECT_EQ(back.vertices, 6u);
  EXPECT_EQ(back.triangles, 7u);
  EXPECT_EQ(back.quads, 8u);
  EXPECT_EQ(back.polygon_triangles, 9u);
  EXPECT_EQ(back.files, 1u);
  EXPECT_EQ(back.measure, asset.measure);
  EXPECT_TRUE(read.labels[1].measure.empty);
  EXPECT_TRUE(read_asset_record(path(), RecordParts::files)->labels.empty());
}

TEST_F(AssetRecordTest, OtherBytesAreNot) {
  write_later("12346");
  EXPECT_FALSE(is_current());
  write_later("123456");
  EXPECT_FALSE(is_current());
  fs::remove(file());
  EXPECT_FALSE(is_current());
}

TEST_F(AssetRecordTest, LinksToThemselvesAreNot) {
  fs::remove(file());
  fs::create_symlink(file().filename(), file());
  EXPECT_FALSE(is_current());
}

TEST_F(AssetRecordTest, FilesThatWereNotThereYetAreComparedByHash) {
  AssetRecord record = *read_asset_record(path());
  fs::remove(file());
  write_asset_record(path(), record, output());
  EXPECT_FALSE(is_current());
  write_later("12345");
  EXPECT_TRUE(is_current());
}

}  // namespace
}  // namespace voxweld
