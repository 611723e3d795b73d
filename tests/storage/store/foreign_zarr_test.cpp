// Zarr v3 arrays as others write them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zstd.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numeric>

#include "storage/store/crc32c.h"
#include "storage/store/open_zarr.h"
#include "storage/support/error.h"
#include "storage/support/file_io.h"
#include "tests/storage/store/zarr_reading.h"
#include "tests/support/deflated.h"
#include "tests/support/temp_directory.h"

namespace voxweld {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using testing::read_all;
using testing::refusal;
using testing::shared_data;
using testing::TempDirectory;
using Json = nlohmann::json;
using Bytes = std::vector<std::byte>;

// Real arrays ------------------------------------------------------------------------------------

TEST(ForeignZarr, ArraysOfZarrsAndZarrPython) {
  VOXWELD_NEEDS_SHARED_DATA("zarr/zarrs/data");
  std::vector<float> expected(100);
  std::iota(expected.begin(), expected.end(), 0.0f);
  for (const char* name :
       {"v3/array_none", "v3/array_blosc", "v3/array_gzip", "v3/array_zstd",
        "v3_zarr_python/array_none", "v3_zarr_python/array_blosc", "v3_zarr_python/array_gzip",
        "v3_zarr_python/array_zstd", "v3_zarr_python/array_bz2", "v3_zarr_python/array_zlib",
        "v3/array_bz2"}) {
    const auto source = open_zarr(shared_data("zarr/zarrs/data") / (std::string(name) + ".zarr"));
    EXPECT_EQ(source->info().geometry.size, (Index3{10, 10, 1}));
    EXPECT_EQ(read_all<float>(*source), expected) << name;
  }
}

TEST(ForeignZarr, AShardedArrayOfZarrs) {
  VOXWELD_NEEDS_SHARED_DATA("zarr/zarrs/data");
  const auto source =
      open_zarr(shared_data("zarr/zarrs/data/sharded_array_write_read.zarr/group/array"));
  EXPECT_EQ(source->info().type, SampleType::u16);
  const auto values = read_all<std::uint16_t>(*source);
  ASSERT_EQ(values.size(), 64U);
  // The four chunks were written as one ascending sequence.
  for (std::uint16_t i = 0; i < 64; ++i) EXPECT_EQ(values[i], i) << i;
}

TEST(ForeignZarr, MissingChunksOfARealArrayAreItsFillValue) {
  VOXWELD_NEEDS_SHARED_DATA("zarr/zarrs/data");
  const auto source = open_zarr(shared_data("zarr/zarrs/data/array_write_read.zarr/group/array"));
  const auto values = read_all<float>(*source);
  ASSERT_EQ(values.size(), 64U);
  EXPECT_TRUE(std::isnan(values[0]));  // chunk 0/0 was never written
}

TEST(ForeignZarr, RealArraysItDoesNotReadAreRefusedByName) {
  VOXWELD_NEEDS_SHARED_DATA("zarr/zarrs/data");
  const auto data = shared_data("zarr/zarrs/data");
  EXPECT_THAT(refusal(data / "v3_zarr_python/array_zfpy.zarr"), HasSubstr("zfpy"));
  EXPECT_THAT(refusal(data / "v3_zarr_python/array_fletcher32.zarr"), HasSubstr("fletcher32"));
  EXPECT_THAT(refusal(data / "v3/array_pcodec.zarr"), HasSubstr("pcodec"));
  EXPECT_THAT(refusal(data / "v3/cities.zarr"), HasSubstr("not supported"));
  EXPECT_THAT(refusal(data / "hierarchy.zarr"),
              AllOf(HasSubstr("several arrays"), HasSubstr("'a/baz'")));
}

TEST(ForeignZarr, EarlyDraftsAndOtherVersionsAreRefusedByName) {
  VOXWELD_NEEDS_SHARED_DATA("zarr/zarr_implementations");
  const auto data = shared_data("zarr/zarr_implementations/examples");
  EXPECT_THAT(refusal(data / "zarrita.zr3"), HasSubstr("zr3"));
  EXPECT_THAT(refusal(data / "zarr.zr"), HasSubstr("'blosc', 'gzip', 'raw', 'zlib'"));
  EXPECT_THAT(refusal(shared_data("zarr/zarr_implementations/data")), HasSubstr("no zarr.json"));
  EXPECT_THAT(refusal(data / "none"), HasSubstr("no such directory"));
  EXPECT_THAT(refusal(data / "zarrita.zr3/zarr.json"), HasSubstr("is a file"));
}

// Arrays made here -------------------------------------------------------------------------------

Json codec(const char* name, Json configuration = Json::object()) {
  return Json{{"name", name}, {"configuration", std::move(configuration)}};
}

Json plain_metadata() {
  return {{"zarr_format", 3},
          {"node_type", "array"},
          {"shape", {3, 2, 5}},
          {"data_type", "int16"},
          {"chunk_grid", {{"name", "regular"}, {"configuration", {{"chunk_shape", {2, 2, 4}}}}}},
          {"chunk_key_encoding", {{"name", "default"}}},
          {"fill_value", -7},
          {"codecs", Json::array({codec("bytes", {{"endian", "little"}})})},
          {"attributes", Json::object()}};
}

class MadeZarr : public ::testing::Test {
 protected:
  std::filesystem::path array() const { return directory_ / "a.zarr"; }
  void write_metadata(const Json& metadata) {
    write_whole_file(array() / "zarr.json", as_bytes(metadata.dump()), Durability::rename_only);
  }
  void write_chunk(const char* key, std::span<const std::byte> bytes) {
    write_whole_file(array() / key, bytes, Durability::rename_only);
  }
  // Refused, naming zarr.json and `part`.
  void expect_refused(const Json& metadata, const char* part) {
    write_metadata(metadata);
    EXPECT_THAT(refusal(array()), AllOf(HasSubstr("zarr.json"), HasSubstr(part)));
  }

  const TempDirectory directory_;
};

template <class T>
Bytes bytes_of(const std::vector<T>& values) {
  Bytes bytes(values.size() * sizeof(T));
  std::memcpy(bytes.data(), values.data(), bytes.size());
  return bytes;
}

// Chunk (0, 0, 0): 2 x 2 x 4 samples counting up.
std::vector<std::int16_t> chunk_values() {
  std::vector<std::int16_t> values(16);
  std::iota(values.begin(), values.end(), std::int16_t{100});
  return values;
}
// The array with that chunk alone.
std::vector<std::int16_t> array_values() {
  std::vector<std::int16_t> values(30, -7);
  for (std::size_t z = 0; z < 2; ++z)
    for (std::size_t y = 0; y < 2; ++y)
      for (std::size_t x = 0; x < 4; ++x)
        values[(z * 2 + y) * 5 + x] = static_cast<std::int16_t>(100 + (z * 2 + y) * 4 + x);
  return values;
}

Bytes gzipped(const Bytes& data) {
  return testing::deflated(data, testing::Wrapper::gzip);
}

Bytes zstd_compressed(const Bytes& data) {
  Bytes out(ZSTD_compressBound(data.size()));
  out.resize(ZSTD_compress(out.data(), out.size(), data.data(), data.size(), 3));
  return out;
}

Bytes with_crc(Bytes data) {
  const std::uint32_t crc = crc32c(data);
  const auto* at = reinterpret_cast<const std::byte*>(&crc);
  data.insert(data.end(), at, at + 4);
  return data;
}

Bytes big_endian(Bytes data, std::size_t each) {
  for (std::size_t i = 0; i < data.size(); i += each)
    std::reverse(data.data() + i, data.data() + i + each);
  return data;
}

TEST_F(MadeZarr, DimensionsAreTakenByName) {
  Json metadata = plain_metadata();
  metadata["dimension_names"] = {"x", "z", "y"};
  write_metadata(metadata);
  const auto source = open_zarr(array());
  EXPECT_EQ(source->info().geometry.size, (Index3{3, 5, 2}));
  EXPECT_EQ(read_all<std::int16_t>(*source), std::vector<std::int16_t>(30, -7));
  metadata["dimension_names"] = {"time", "y", "x"};
  expect_refused(metadata, "holds 3 times, of which one is read");
  metadata["dimension_names"] = {"time", "z", "y"};
  expect_refused(metadata, "the dimensions are time, z, y");
  for (const Json& names : {Json({"a", "b", "c d"}), Json({nullptr, "y", "x"}), Json(nullptr)}) {
    metadata["dimension_names"] = names;
    write_metadata(metadata);
    EXPECT_EQ(open_zarr(array())->info().geometry.size, (Index3{5, 2, 3})) << names;
  }
}

TEST_F(MadeZarr, EveryChainOfCodecs) {
  const Json little = codec("bytes", {{"endian", "little"}});
  const Json big = codec("bytes", {{"endian", "big"}});
  const Json crc = {{"name", "crc32c"}};
  const Json gzip = codec("gzip", {{"level", 6}}), zstd = codec("zstd", {{"level", 3}});
  const Json transpose = codec("transpose", {{"order", {0, 1, 2}}});
  const Bytes raw = bytes_of(chunk_values());
  const std::vector<std::pair<Json, Bytes>> cases = {
      {Json::array({little}), raw},
      {Json::array({transpose, little}), raw},
      {Json::array({big}), big_endian(raw, 2)},
      {Json::array({little, crc}), with_crc(raw)},
      {Json::array({little, gzip}), gzipped(raw)},
      {Json::array({little, zstd, crc}), with_crc(zstd_compressed(raw))},
      {Json::array({big, crc, gzip, crc}), with_crc(gzipped(with_crc(big_endian(raw, 2))))},
  };
  for (const auto& [codecs, chunk] : cases) {
    Json metadata = plain_metadata();
    metadata["codecs"] = codecs;
    write_metadata(metadata);
    write_chunk("c/0/0/0", chunk);
    EXPECT_EQ(read_all<std::int16_t>(*open_zarr(array())), array_values()) << codecs;
    for (std::size_t size = 0; size < chunk.size(); ++size) {
      write_chunk("c/0/0/0", std::span(chunk).first(size));
      ASSERT_THAT(refusal(array()), HasSubstr("c/0/0/0")) << codecs << " cut at " << size;
    }
    Bytes longer = chunk;
    longer.resize(chunk.size() + 1);
    write_chunk("c/0/0/0", longer);
    EXPECT_THAT(refusal(array()), HasSubstr("c/0/0/0")) << codecs;
  }
}

TEST_F(MadeZarr, EveryFormOfChunkKey) {
  for (const auto& [encoding, key] : std::vector<std::pair<Json, const char*>>{
           {{{"name", "default"}, {"configuration", {{"separator", "."}}}}, "c.0.0.0"},
           {{{"name", "v2"}}, "0.0.0"},
           {{{"name", "v2"}, {"configuration", {{"separator", "/"}}}}, "0/0/0"}}) {
    Json metadata = plain_metadata();
    metadata["chunk_key_encoding"] = encoding;
    write_metadata(metadata);
    write_chunk(key, bytes_of(chunk_values()));
    EXPECT_EQ(read_all<std::int16_t>(*open_zarr(array())), array_values()) << key;
  }
}

// One shard of 2 x 2 x 8 samples, its first inner chunk as above, the other missing.
TEST_F(MadeZarr, EveryFormOfShardIndex) {
  const Json little = codec("bytes", {{"endian", "little"}});
  const Json crc = {{"name", "crc32c"}};
  for (const bool at_end : {true, false})
    for (const bool checked : {true, false})
      for (const bool big : {true, false}) {
        Json index = Json::array({codec("bytes", {{"endian", big ? "big" : "little"}})});
        if (checked) index.push_back(crc);
        Json metadata = plain_metadata();
        metadata["chunk_grid"]["configuration"]["chunk_shape"] = {2, 2, 8};
        metadata["codecs"] = Json::array(
            {codec("sharding_indexed", {{"chunk_shape", {2, 2, 4}},
                                        {"codecs", Json::array({little, crc})},
                                        {"index_codecs", index},
                                        {"index_location", at_end ? "end" : "start"}})});
        write_metadata(metadata);
        const Bytes chunk = with_crc(bytes_of(chunk_values()));
        const std::uint64_t index_size = 32 + (checked ? 4 : 0), none = ~std::uint64_t{0};
        const std::uint64_t start = at_end ? 0 : index_size;
        Bytes entries =
            bytes_of(std::vector<std::uint64_t>{start, std::uint64_t{chunk.size()}, none, none});
        if (big) entries = big_endian(entries, 8);
        if (checked) entries = with_crc(entries);
        Bytes file = at_end ? chunk : entries;
        file.insert(file.end(), at_end ? entries.begin() : chunk.begin(),
                    at_end ? entries.end() : chunk.end());
        write_chunk("c/0/0/0", file);
        EXPECT_EQ(read_all<std::int16_t>(*open_zarr(array())), array_values());
        for (std::size_t size = 0; size < file.size(); ++size) {
          write_chunk("c/0/0/0", std::span(file).first(size));
          ASSERT_THAT(refusal(array()), HasSubstr("c/0/0/0"));
        }
      }
}

TEST_F(MadeZarr, AnIndexThatPointsOutsideIsRefused) {
  Json metadata = plain_metadata();
  metadata["codecs"] = Json::array(
      {codec("sharding_indexed",
             {{"chunk_shape", {2, 2, 4}},
              {"codecs", Json::array({codec("bytes", {{"endian", "little"}})})},
              {"index_codecs", Json::array({codec("bytes", {{"endian", "little"}})})}})});
  write_metadata(metadata);
  using Entry = std::vector<std::uint64_t>;
  constexpr std::uint64_t none = ~std::uint64_t{0};
  for (const Entry& entry : {Entry{0, none}, Entry{none, 16}, Entry{none - 8, 32}, Entry{17, 32},
                             Entry{0, std::uint64_t{1} << 60}, Entry{0, 31}}) {
    Bytes file(16);
    const Bytes index = bytes_of(entry);
    file.insert(file.end(), index.begin(), index.end());
    write_chunk("c/0/0/0", file);
    EXPECT_THAT(refusal(array()), HasSubstr("c/0/0/0")) << entry[0] << ' ' << entry[1];
  }
}

TEST_F(MadeZarr, FillValues) {
  Json metadata = plain_metadata();
  metadata["data_type"] = "float32";
  const auto fill = [&](const Json& value) {
    metadata["fill_value"] = value;
    write_metadata(metadata);
    return read_all<float>(*open_zarr(array()))[0];
  };
  EXPECT_EQ(fill(1.5), 1.5f);
  EXPECT_TRUE(std::isnan(fill("NaN")));
  EXPECT_EQ(fill("-Infinity"), -INFINITY);
  EXPECT_EQ(fill("0x40490fdb"), 3.14159274f);
  for (const Json& wrong : {Json("nan"), Json("0x4049"), Json(nullptr), Json(true)}) {
    metadata["fill_value"] = wrong;
    expect_refused(metadata, "fill_value");
  }
  metadata["data_type"] = "uint8";
  for (const Json& wrong : {Json(-1), Json(256), Json(1.0), Json("NaN")}) {
    metadata["fill_value"] = wrong;
    expect_refused(metadata, "fill_value");
  }
}

TEST_F(MadeZarr, WhatIsNotSupportedIsRefusedByName) {
  const auto refuse = [&](const char* pointer, const Json& value, const char* part) {
    Json metadata = plain_metadata();
    metadata[Json::json_pointer(pointer)] = value;
    expect_refused(metadata, part);
  };
  refuse("/zarr_format", 2, "zarr_format: 3 expected, 2 found");
  refuse("/zarr_format", 4, "zarr_format: 3 expected, 4 found");
  refuse("/node_type", "group", "is a group");
  refuse("/data_type", "complex64", "complex64");
  refuse("/data_type", "short", "short");
  refuse("/data_type", {{"name", "numpy.datetime64"}}, "datetime64");
  refuse("/shape", {4}, "1 dimensions");
  refuse("/shape", {2, 2, 4, 4}, "4 dimensions of 2 x 2 x 4 x 4 samples");
  refuse("/shape", {4, 0, 4}, "shape[1]");
  refuse("/shape", {1LL << 39, 1LL << 39, 4}, "2^63");
  refuse("/shape", "big", "shape: a list expected");
  refuse("/chunk_grid/name", "rectangular", "rectangular");
  refuse("/chunk_grid/configuration/chunk_shape", {2, 2}, "3 extents expected");
  refuse("/chunk_key_encoding/name", "hashed", "hashed");
  refuse("/chunk_key_encoding/configuration", {{"separator", "-"}}, "separator");
  refuse("/codecs/0/configuration", Json::object(), "endian");
  refuse("/codecs/0/configuration/endian", "middle", "middle");
  refuse("/codecs", Json::array(), "no \"bytes\" codec");
  refuse("/codecs/1", codec("lzma"), "codecs[1]");
  refuse("/codecs/1", codec("lzma"), "lzma");
  refuse("/storage_transformers", Json::array({codec("cache")}), "cache");
  refuse("/novelty", 1, "novelty");
  Json metadata = plain_metadata();
  metadata["novelty"] = {{"must_understand", false}};
  write_metadata(metadata);
  EXPECT_EQ(read_all<std::int16_t>(*open_zarr(array())).size(), 30U);
  metadata.erase("fill_value");
  expect_refused(metadata, "fill_value");
  write_whole_file(array() / "zarr.json", as_bytes("{\"zarr_format\": 3,"),
                   Durability::rename_only);
  EXPECT_THAT(refusal(array()), HasSubstr("not valid JSON: parse error at line 1"));
  const std::string deep = std::string(1000000, '[') + std::string(1000000, ']');
  write_whole_file(array() / "zarr.json", as_bytes(deep), Durability::rename_only);
  EXPECT_THAT(refusal(array()), HasSubstr("64 deep"));
}

TEST_F(MadeZarr, AChunkBeyondAllMemoryIsRefused) {
  Json metadata = plain_metadata();
  const auto side = std::int64_t{1} << 20;
  metadata["chunk_grid"]["configuration"]["chunk_shape"] = {side, side, side};
  metadata["codecs"].push_back(codec("zstd"));
  expect_refused(metadata, "one chunk takes");
  metadata["codecs"] = Json::array(
      {codec("sharding_indexed", {{"chunk_shape", {1, 1, 1}},
                                  {"codecs", Json::array({codec("bytes", {{"endian", "little"}})})},
                                  {"index_codecs", Json::array({{{"name", "crc32c"}}})}})});
  expect_refused(metadata, "2^32 chunks");
}

}  // namespace
}  // namespace voxweld
