// Arrays of N5 made byte by byte, and those of z5py.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <numeric>

#include "storage/store/open_zarr.h"
#include "storage/support/error.h"
#include "storage/support/file_io.h"
#include "tests/storage/store/array_writers.h"
#include "tests/storage/store/zarr_reading.h"
#include "tests/support/temp_directory.h"

namespace voxweld {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using testing::lz4_blocks;
using testing::n5_header;
using testing::read_all;
using testing::shared_data;
using Json = nlohmann::json;

std::unique_ptr<SampleSource> open_n5(const std::filesystem::path& path) {
  return n5_reader().open({.path = path.string()});
}

std::string n5_refusal(const std::filesystem::path& path) {
  try {
    read_all<std::byte>(*open_n5(path));
  } catch (const Error& error) {
    EXPECT_EQ(error.exit_code(), 2);
    return error.what();
  }
  return "accepted";
}

TEST(N5, ArraysOfZ5pyAreThoseOfZarrPython) {
  VOXWELD_NEEDS_SHARED_DATA("zarr/zarr_implementations");
  const auto examples = shared_data("zarr/zarr_implementations/examples");
  const auto expected = read_all<std::uint8_t>(*open_zarr(examples / "zarr.zr/raw"));
  for (const char* name : {"raw", "gzip"})
    EXPECT_EQ(read_all<std::uint8_t>(*open_n5(examples / "z5py.n5" / name)), expected) << name;
  EXPECT_THAT(n5_refusal(examples / "z5py.n5"), HasSubstr("'gzip', 'raw'"));
}

// 5 x 3 x 2 samples in blocks of 4 x 2 x 2, of which those at the upper borders are cut short.
class MadeN5 : public ::testing::Test {
 protected:
  static std::int16_t value(std::int64_t x, std::int64_t y, std::int64_t z) {
    return static_cast<std::int16_t>(1000 * z + 100 * y + x - 300);
  }
  std::filesystem::path array() const { return directory_ / "a"; }
  static Json attributes() {
    return {{"dimensions", {5, 3, 2}},
            {"blockSize", {4, 2, 2}},
            {"dataType", "int16"},
            {"compression", {{"type", "raw"}}}};
  }
  void write(const std::filesystem::path& path, const std::string& text) const {
    write_whole_file(path, as_bytes(text), Durability::rename_only);
  }
  void write_attributes(const Json& json) const { write(array() / "attributes.json", json.dump()); }
  static std::string block(Index3 at, const std::function<std::string(std::string)>& pack) {
    const Index3 size = min(Index3{4, 2, 2}, Index3{5 - 4 * at.x, 3 - 2 * at.y, 2});
    std::string samples;
    each_index(size, [&](Index3 p) {
      samples += testing::number_bytes(
          static_cast<std::uint16_t>(value(4 * at.x + p.x, 2 * at.y + p.y, p.z)), 2,
          std::endian::big);
    });
    return n5_header({static_cast<std::uint64_t>(size.x), static_cast<std::uint64_t>(size.y), 2}) +
           pack(samples);
  }
  void write_blocks(const std::function<std::string(std::string)>& pack) const {
    each_index(Index3{2, 2, 1}, [&](Index3 at) {
      if (at.x == 1 && at.y == 1) return;  // missing: 0
      write(array() / fmt::format("{}/{}/0", at.x, at.y), block(at, pack));
    });
  }
  static std::string as_is(std::string bytes) { return bytes; }
  void expect_samples() const {
    const auto source = open_n5(array());
    const auto values = read_all<std::int16_t>(*source);
    ASSERT_EQ(values.size(), 30U);
    each_index(Index3{5, 3, 2}, [&](Index3 p) {
      const bool there = p.x < 4 || p.y < 2;
      EXPECT_EQ(values[static_cast<std::size_t>((p.z * 3 + p.y) * 5 + p.x)],
                there ? value(p.x, p.y, p.z) : 0);
    });
  }

  const testing::TempDirectory directory_;
};

TEST_F(MadeN5, BlocksThatAreCutShort) {
  write_attributes(attributes());
  write_blocks(as_is);
  expect_samples();
}

TEST_F(MadeN5, TheStreamOfLz4Java) {
  Json json = attributes();
  json["compression"] = {{"type", "lz4"}, {"blockSize", 65536}};
  write_attributes(json);
  write_blocks([](std::string bytes) { return lz4_blocks(bytes, 12); });
  expect_samples();
  const std::string whole = block({}, [](std::string bytes) { return lz4_blocks(bytes, 12); });
  for (std::size_t size = 0; size + 21 < whole.size(); ++size) {  // the last header may be missing
    write(array() / "0/0/0", whole.substr(0, size));
    EXPECT_THAT(n5_refusal(array()), HasSubstr("0/0/0")) << size;
  }
  for (std::size_t at = 16; at < whole.size() - 21; ++at) {
    std::string changed = whole;
    changed[at] = static_cast<char>(changed[at] ^ 0x41);
    write(array() / "0/0/0", changed);
    // The low half of a token says how large blocks may be, which nothing depends on.
    const bool matters = (at - 16) % 33 != 8;
    EXPECT_TRUE(n5_refusal(array()) != "accepted" || !matters) << at;
  }
}

TEST_F(MadeN5, OldMetadataAndBlocksWithACount) {
  Json json = attributes();
  json.erase("compression");
  json["compressionType"] = "gzip";
  write_attributes(json);
  write_blocks([](std::string bytes) {
    const auto packed = testing::deflated(std::as_bytes(std::span(bytes)), testing::Wrapper::gzip);
    return std::string(reinterpret_cast<const char*>(packed.data()), packed.size());
  });
  expect_samples();
  write_attributes(attributes());
  write_blocks(as_is);
  const auto counted = [&](unsigned count) {
    const std::string samples = block({}, as_is).substr(16);
    return n5_header({4, 2, 2}, 1) + testing::number_bytes(count, 4, std::endian::big) + samples;
  };
  write(array() / "0/0/0", counted(16));
  expect_samples();
  write(array() / "0/0/0", counted(15));
  EXPECT_THAT(n5_refusal(array()), HasSubstr("15 elements for 16 samples"));
}

TEST_F(MadeN5, DamagedBlocksAreNamed) {
  write_attributes(attributes());
  write_blocks(as_is);
  const std::string whole = block({}, as_is), samples = whole.substr(16);
  for (std::size_t size = 0; size < whole.size(); ++size) {
    write(array() / "0/0/0", whole.substr(0, size));
    EXPECT_THAT(n5_refusal(array()), HasSubstr("0/0/0")) << size;
  }
  for (const auto& [header, said] : std::vector<std::pair<std::string, const char*>>{
           {n5_header({4, 2, 2}, 2), "mode 2"},
           {n5_header({4, 2, 2}, 77), "mode 77"},
           {n5_header({4, 4}), "2 dimensions, 3 expected"},
           {n5_header({3, 2, 2}), "3 samples long in dimension 0, 4 to 4 expected"},
           {n5_header({4, 2, 0xffffffff}), "4294967295 samples long in dimension 2"},
           {n5_header({4, 2, 0}), "0 samples long"}}) {
    write(array() / "0/0/0", header + samples);
    EXPECT_THAT(n5_refusal(array()), AllOf(HasSubstr("0/0/0"), HasSubstr(said)));
  }
}

TEST_F(MadeN5, WhatIsNotSupportedIsRefusedByName) {
  const auto refused = [&](const char* key, const Json& value, const char* part) {
    Json json = attributes();
    json[key] = value;
    write_attributes(json);
    EXPECT_THAT(n5_refusal(array()), AllOf(HasSubstr("attributes.json"), HasSubstr(part)));
  };
  refused("dataType", "object", "\"object\" is not supported");
  refused("dataType", "string", "\"string\" is not supported");
  refused("compression", {{"type", "jpeg"}}, "\"jpeg\" is not supported");
  refused("isLabelMultiset", true, "label multisets");
  refused("dimensions", {5, 3, 2, 4}, "4 dimensions of 4 x 2 x 3 x 5");
  refused("dimensions", {5, 0, 2}, "an integer from 1");
  refused("blockSize", {4, 2}, "3 extents expected");
  refused("blockSize", {1 << 20, 1 << 20, 1 << 20}, "one chunk takes");
}

// As several viewers write it.
TEST_F(MadeN5, SpacingsByEveryCustom) {
  Json group = Json::object(), own = attributes();
  const auto geometry = [&](const char* level = "s1") {
    for (const char* name : {"s0", "s1"}) {
      Json at = attributes();
      if (std::string(name) == "s1") at.update(own);
      write(directory_ / "g/c0" / name / "attributes.json", at.dump());
    }
    write(directory_ / "g/c0/attributes.json", group.dump());
    const auto source = open_n5(directory_ / "g/c0" / level);
    InputSpec chosen{.path = (directory_ / "g/c0").string()};
    chosen.select.level = level[1] - '0';
    EXPECT_EQ(n5_reader().open(chosen)->info().geometry.spacing, source->info().geometry.spacing);
    return source->info().geometry;
  };
  group["scales"] = {{1, 1, 1}, {2, 2, 1}};
  group["pixelResolution"] = {{"unit", "um"}, {"dimensions", {0.5, 0.5, 3}}};
  EXPECT_EQ(geometry().spacing, (Vec3{1, 1, 3}));
  EXPECT_EQ(geometry().origin, (Vec3{0.25, 0.25, 0}));
  EXPECT_EQ(geometry().unit, "um");
  EXPECT_EQ(geometry("s0").spacing, (Vec3{0.5, 0.5, 3}));
  group = {{"multiScale", true}, {"resolution", {4, 5, 6}}, {"offset", {10, 0, 0}}};
  own["downsamplingFactors"] = {2, 2, 2};
  EXPECT_EQ(geometry().spacing, (Vec3{8, 10, 12}));
  EXPECT_EQ(geometry().origin, (Vec3{12, 2.5, 3}));
  own = {{"pixelResolution", {{"dimensions", {8, 8, 7}}, {"unit", "nm"}}}};
  EXPECT_EQ(geometry().spacing, (Vec3{8, 8, 7}));
  own["transform"] = {{"axes", {"z", "y", "x"}},
                      {"scale", {6.5, 9, 10}},
                      {"translate", {1, 2, 3}},
                      {"units", {"nm", "nm", "nm"}}};
  EXPECT_EQ(geometry().spacing, (Vec3{10, 9, 6.5}));
  EXPECT_EQ(geometry().origin, (Vec3{3, 2, 1}));
  own["transform"]["axes"] = {"x", "y", "z"};
  EXPECT_EQ(geometry().spacing, (Vec3{6.5, 9, 10}));
  EXPECT_EQ(geometry().unit, "nm");
}

}  // namespace
}  // namespace voxweld
