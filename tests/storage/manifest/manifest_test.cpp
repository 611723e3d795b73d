#include "storage/manifest/manifest.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "storage/support/error.h"
#include "tests/support/error_text.h"
#include "tests/support/temp_directory.h"

namespace voxweld {
namespace {

using nlohmann::json;
using ::testing::AllOf;
using ::testing::HasSubstr;

Manifest sample_manifest() {
  Manifest m;
  m.lattice = {1.0 / 1024, 20, {-0.5, -1.0 / 1024, 0}};
  m.open_border = true;
  m.border_slack = 0.25;
  m.frame.size = {10, 20, 30};
  m.frame.spacing = {0.1, 0.2, 1.0 / 3};
  m.frame.first = {-0.5, 1024, 3};
  m.frame.origin = {-1, 2.5, 1e-7};
  m.frame.direction = {Vec3{0, 1, 0}, Vec3{1, 0, 0}, Vec3{0, 0, -1}};
  m.frame.unit = "mm";
  m.frame.space = "LPS";
  m.labels = LabelMode::each;
  m.counts = {8, 5, 4, {100, 20, 3}, 9007199254740993, 50, 7, 107, 4, 1, 9, 12345, 77};
  m.merged = MergedFiles{{"drc", "mesh.drc"}};
  m.files = {{"mesh.drc", "drc", "merged", 12345678901, "00ff"}};
  m.config = std::make_unique<json>(json{{"contour", {{"tolerance", 0.5}}}});
  return m;
}

TEST(Manifest, ReadsBackWhatWasWritten) {
  const testing::TempDirectory directory;
  const auto path = directory / "manifest.json";
  const Manifest written = sample_manifest();
  write_manifest(written, path, Durability::rename_only);
  const Manifest read = read_manifest(path);
  EXPECT_EQ(read.lattice, written.lattice);
  EXPECT_TRUE(read.open_border);
  EXPECT_EQ(read.border_slack, 0.25);
  EXPECT_FALSE(read.free_topology);
  EXPECT_EQ(read.labels, LabelMode::each);
  EXPECT_EQ(read.frame.size, written.frame.size);
  EXPECT_EQ(read.frame.spacing, written.frame.spacing);
  EXPECT_EQ(read.frame.first, written.frame.first);
  EXPECT_EQ(read.frame.origin, written.frame.origin);
  EXPECT_EQ(read.frame.direction, written.frame.direction);
  EXPECT_EQ(read.frame.unit, "mm");
  EXPECT_EQ(read.frame.space, "LPS");
  EXPECT_EQ(read.counts, written.counts);
  EXPECT_EQ(read.merged, written.merged);
  EXPECT_EQ(read.files, written.files);
  ASSERT_NE(read.config, nullptr);
  EXPECT_EQ(*read.config, *written.config);
  EXPECT_EQ(read.input, nullptr);
}

// Writes the sample with one change and returns the error's text.
std::string error_after(const std::function<void(json&)>& change) {
  const testing::TempDirectory directory;
  const auto path = directory / "manifest.json";
  write_manifest(sample_manifest(), path, Durability::rename_only);
  const auto bytes = read_whole_file(path);
  json document = json::parse(reinterpret_cast<const char*>(bytes.data()),
                              reinterpret_cast<const char*>(bytes.data()) + bytes.size());
  change(document);
  const std::string text = document.dump();
  write_whole_file(path, as_bytes(text), Durability::rename_only);
  return testing::error_text<FormatError>([&] { read_manifest(path); });
}

TEST(Manifest, NamesPathKeyAndValueOfWhatIsWrong) {
  const auto says = [](const std::string& key, const std::string& more) {
    return AllOf(HasSubstr("manifest.json"), HasSubstr("\"" + key + "\""), HasSubstr(more));
  };
  EXPECT_THAT(error_after([](json& j) { j["format"] = "other"; }), says("format", "other"));
  EXPECT_THAT(error_after([](json& j) { j["version"] = 2; }),
              says("version", "expected 3, as this voxweld writes it (make the mesh anew)"));
  EXPECT_THAT(error_after([](json& j) { j.erase("lattice"); }), says("lattice", "missing"));
  EXPECT_THAT(error_after([](json& j) { j["lattice"]["bits"] = 23; }), says("lattice.bits", "22"));
  EXPECT_THAT(error_after([](json& j) { j["lattice"]["step"] = 0; }), says("lattice.step", "0"));
  EXPECT_THAT(error_after([](json& j) {
                j["lattice"]["origin"] = {1, 2};
              }),
              says("lattice.origin", "3 values"));
  EXPECT_THAT(error_after([](json& j) { j["border"] = "ajar"; }), says("border", "ajar"));
  EXPECT_THAT(error_after([](json& j) { j["counts"]["quads"] = -1; }), says("counts.quads", "-1"));
  EXPECT_THAT(error_after([](json& j) { j["files"][0]["bytes"] = "7"; }),
              says("files[0].bytes", "count"));
  EXPECT_THAT(error_after([](json& j) { j["files"][0]["path"] = "../x"; }),
              says("files[0].path", "inside"));
  EXPECT_THAT(error_after([](json& j) { j["merged"]["drc"] = "/etc/x"; }),
              says("merged.drc", "inside"));
  EXPECT_THAT(error_after([](json& j) { j = json::array(); }), HasSubstr("the document"));
}

TEST(Manifest, RefusesEveryTruncation) {
  const testing::TempDirectory directory;
  const auto path = directory / "manifest.json";
  write_manifest(sample_manifest(), path, Durability::rename_only);
  const auto whole = read_whole_file(path);
  for (std::size_t size = 0; size + 2 < whole.size(); ++size) {
    write_whole_file(path, std::span(whole).first(size), Durability::rename_only);
    EXPECT_THROW(read_manifest(path), FormatError) << size;
  }
  EXPECT_THROW(read_manifest(directory / "none.json"), StorageError);
}

TEST(Manifest, RefusesNumbersThatNoDoubleHolds) {
  const testing::TempDirectory directory;
  const auto path = directory / "manifest.json";
  write_whole_file(path, as_bytes("{\"counts\": 1e999}"), Durability::rename_only);
  EXPECT_THAT(testing::error_text<FormatError>([&] { read_manifest(path); }),
              AllOf(HasSubstr("manifest.json"), HasSubstr("a number in it is too large")));
}

TEST(TileList, ReadsBackLinesAndNamesBadOnes) {
  const TileRecord a{{}, {3, {1, 0, 7}}, 10, 20, 9, 2, {{"tiles/a.drc", "drc", "", 99, "ab"}}};
  const TileRecord b{12, {0, {5, 6, 7}}, 1, 2, 1, 0, {}};
  const TileRecord c{{}, {4, {0, 0, 3}}, 5, 6, 0, 6, {}, 2};
  const TileRecord d{9, {7, {0, 0, 0}}, 1, 2, 1, 0, {}, 0, CellKey{4, {1, 2, 3}}};
  const testing::TempDirectory directory;
  const auto path = directory / "tiles.jsonl";
  write_whole_file(path,
                   as_bytes(to_json_line(a) + to_json_line(b) + to_json_line(c) + to_json_line(d) +
                            "{\"tile\":3}\n"),
                   Durability::rename_only);
  TileListReader reader(path);
  EXPECT_EQ(reader.next(), a);
  EXPECT_EQ(reader.next(), b);
  EXPECT_EQ(reader.next(), c);
  EXPECT_EQ(reader.next(), d);
  EXPECT_THAT(testing::error_text<FormatError>([&] { reader.next(); }),
              AllOf(HasSubstr("tiles.jsonl line 5"), HasSubstr("\"tile\"")));
  EXPECT_EQ(reader.next(), std::nullopt);
  EXPECT_THROW(TileListReader(directory / "none"), StorageError);
  std::filesystem::create_symlink("/dev/zero", directory / "endless");
  EXPECT_THROW(TileListReader(directory / "endless"), FormatError);
}

}  // namespace
}  // namespace voxweld
