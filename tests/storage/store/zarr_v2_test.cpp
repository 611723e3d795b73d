// Zarr arrays of version 2, and chunks whose samples are in another order.
#include <bzlib.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <lz4.h>

#include <nlohmann/json.hpp>
#include <numeric>

#include "storage/store/codec.h"
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
using testing::read_box;
using testing::refusal;
using testing::shared_data;
using Json = nlohmann::json;
using Bytes = std::vector<std::byte>;

// Real arrays ------------------------------------------------------------------------------------

TEST(ZarrV2, ArraysOfZarrsAndTransposedOnes) {
  VOXWELD_NEEDS_SHARED_DATA("zarr/zarrs/data");
  std::vector<float> expected(100);
  std::iota(expected.begin(), expected.end(), 0.0f);
  for (const char* name :
       {"v2/array_none_C", "v2/array_none_F", "v2/array_blosc_C", "v2/array_blosc_F",
        "v2/array_bz2_C", "v2/array_gzip_C", "v2/array_zstd_C", "v3/array_none_transpose",
        "v3/array_blosc_transpose"}) {
    const auto source = open_zarr(shared_data("zarr/zarrs/data") / (std::string(name) + ".zarr"));
    EXPECT_EQ(source->info().geometry.size, (Index3{10, 10, 1})) << name;
    EXPECT_EQ(read_all<float>(*source), expected) << name;
  }
}

TEST(ZarrV2, RealArraysItDoesNotReadAreRefusedByName) {
  VOXWELD_NEEDS_SHARED_DATA("zarr/zarrs/data");
  const auto data = shared_data("zarr/zarrs/data");
  EXPECT_THAT(refusal(data / "v2/array_zfpy_C.zarr"), HasSubstr("\"zfpy\" is not supported"));
  EXPECT_THAT(refusal(data / "v2/array_pcodec_C.zarr"), HasSubstr("pcodec"));
  EXPECT_THAT(refusal(data / "zarr_python_compat/fletcher32.zarr"), HasSubstr("fletcher32"));
}

TEST(ZarrV2, OneImageByManyWriters) {
  VOXWELD_NEEDS_SHARED_DATA("zarr/zarr_implementations");
  const auto examples = shared_data("zarr/zarr_implementations/examples/zarr.zr");
  const auto expected = read_all<std::uint8_t>(*open_zarr(examples / "raw"));
  ASSERT_EQ(expected.size(), 512U * 512 * 3);
  for (const char* codec : {"gzip", "zlib", "blosc"})
    EXPECT_EQ(read_all<std::uint8_t>(*open_zarr(examples / codec)), expected) << codec;
}

// Arrays made here -------------------------------------------------------------------------------

Json metadata_of(const char* dtype, const char* order) {
  return {{"zarr_format", 2},      {"shape", {3, 2, 5}}, {"chunks", {2, 2, 4}},
          {"dtype", dtype},        {"order", order},     {"compressor", nullptr},
          {"fill_value", nullptr}, {"filters", nullptr}};
}

Bytes zlib(std::span<const std::byte> raw) {
  return testing::deflated(raw, testing::Wrapper::zlib);
}
Bytes gzip(std::span<const std::byte> raw) {
  return testing::deflated(raw, testing::Wrapper::gzip);
}
Bytes lz4(std::span<const std::byte> raw) {
  Bytes out(4 + static_cast<std::size_t>(LZ4_compressBound(static_cast<int>(raw.size()))));
  const auto size = static_cast<std::uint32_t>(raw.size());
  std::memcpy(out.data(), &size, 4);
  const int made = LZ4_compress_default(
      reinterpret_cast<const char*>(raw.data()), reinterpret_cast<char*>(out.data() + 4),
      static_cast<int>(raw.size()), static_cast<int>(out.size() - 4));
  out.resize(4 + static_cast<std::size_t>(made));
  return out;
}
Bytes bz2(std::span<const std::byte> raw) {
  Bytes out(raw.size() * 2 + 600);
  auto size = static_cast<unsigned>(out.size());
  Bytes copy(raw.begin(), raw.end());
  EXPECT_EQ(BZ2_bzBuffToBuffCompress(reinterpret_cast<char*>(out.data()), &size,
                                     reinterpret_cast<char*>(copy.data()),
                                     static_cast<unsigned>(copy.size()), 9, 0, 0),
            BZ_OK);
  out.resize(size);
  return out;
}
Bytes by_codec(CompressorKind kind, std::span<const std::byte> raw, std::size_t sample) {
  CodecChain chain;
  chain.compressor = Compressor{.kind = kind};
  Bytes out;
  encode_chunk(chain, {raw.size(), sample}, raw, out);
  return out;
}

template <class T>
T value_at(std::int64_t z, std::int64_t y, std::int64_t x) {
  return static_cast<T>(100 * z + 10 * y + x);
}

struct Packing {
  Json compressor;
  std::function<Bytes(std::span<const std::byte>)> pack;
};

class MadeZarrV2 : public ::testing::Test {
 protected:
  std::filesystem::path array() const { return directory_ / "a.zarr"; }
  void write(const Json& metadata) const {
    write_whole_file(array() / ".zarray", as_bytes(metadata.dump()), Durability::rename_only);
  }
  // With value_at; chunk (1, 0, 1) is left out.
  template <class T>
  void write_chunks(const Json& metadata, const Packing& packing) const {
    const bool big = metadata.at("dtype").get<std::string>()[0] == '>';
    const bool columns = metadata.at("order") == "F";
    const std::string separator = metadata.value("dimension_separator", ".");
    for (int cz = 0; cz < 2; ++cz)
      for (int cx = 0; cx < 2; ++cx) {
        if (cz == 1 && cx == 1) continue;
        Bytes raw(16 * sizeof(T));
        for (int z = 0; z < 2; ++z)
          for (int y = 0; y < 2; ++y)
            for (int x = 0; x < 4; ++x) {
              const T value = value_at<T>(2 * cz + z, y, 4 * cx + x);
              const int at = columns ? z + 2 * (y + 2 * x) : x + 4 * (y + 2 * z);
              std::byte* to = &raw[static_cast<std::size_t>(at) * sizeof(T)];
              std::memcpy(to, &value, sizeof(T));
              if (big) std::reverse(to, to + sizeof(T));
            }
        const std::string key = fmt::format("{0}{1}0{1}{2}", cz, separator, cx);
        write_whole_file(array() / key, packing.pack(raw), Durability::rename_only);
      }
  }
  template <class T>
  void expect_samples(T fill) const {
    const auto source = open_zarr(array());
    EXPECT_EQ(source->info().geometry.size, (Index3{5, 2, 3}));
    const auto values = read_all<T>(*source);
    ASSERT_EQ(values.size(), 30U);
    for (int z = 0; z < 3; ++z)
      for (int y = 0; y < 2; ++y)
        for (int x = 0; x < 5; ++x)
          EXPECT_EQ(values[static_cast<std::size_t>((z * 2 + y) * 5 + x)],
                    z == 2 && x == 4 ? fill : value_at<T>(z, y, x))
              << z << y << x;
    // Part of it, across chunks.
    const Bytes part = read_box(*source, {{3, 1, 1}, {5, 2, 2}});
    T two[2];
    std::memcpy(two, part.data(), sizeof two);
    EXPECT_EQ(two[0], static_cast<T>(113));
    EXPECT_EQ(two[1], static_cast<T>(114));
  }

  const testing::TempDirectory directory_;
};

TEST_F(MadeZarrV2, EveryCompressorOrderAndSeparator) {
  const std::vector<Packing> packings = {
      {nullptr, [](auto raw) { return Bytes(raw.begin(), raw.end()); }},
      {{{"id", "zlib"}, {"level", 1}}, zlib},
      {{{"id", "gzip"}, {"level", 1}}, gzip},
      {{{"id", "bz2"}, {"level", 1}}, bz2},
      {{{"id", "lz4"}, {"acceleration", 1}}, lz4},
      {{{"id", "zstd"}, {"level", 1}},
       [](auto raw) { return by_codec(CompressorKind::zstd, raw, 2); }},
      {{{"id", "blosc"}, {"cname", "lz4"}, {"clevel", 5}, {"shuffle", 1}, {"blocksize", 0}},
       [](auto raw) { return by_codec(CompressorKind::blosc, raw, 2); }}};
  for (const Packing& packing : packings)
    for (const char* order : {"C", "F"})
      for (const char* separator : {".", "/"}) {
        SCOPED_TRACE(packing.compressor.dump() + order + separator);
        std::filesystem::remove_all(array());
        Json metadata = metadata_of("<i2", order);
        metadata["compressor"] = packing.compressor;
        metadata["dimension_separator"] = separator;
        metadata["fill_value"] = -7;
        write(metadata);
        write_chunks<std::int16_t>(metadata, packing);
        expect_samples<std::int16_t>(-7);
      }
}

TEST_F(MadeZarrV2, EveryTypeAndByteOrder) {
  const auto check = [&]<class T>(T, const std::vector<const char*>& dtypes) {
    for (const char* dtype : dtypes) {
      SCOPED_TRACE(dtype);
      std::filesystem::remove_all(array());
      const Json metadata = metadata_of(dtype, "F");
      write(metadata);
      write_chunks<T>(metadata, {nullptr, [](auto raw) { return Bytes(raw.begin(), raw.end()); }});
      expect_samples<T>(0);  // no fill value is said
    }
  };
  check(std::uint8_t{}, {"|u1", "<u1", "|b1"});
  check(std::int8_t{}, {"|i1"});
  check(std::uint16_t{}, {"<u2", ">u2"});
  check(std::int32_t{}, {"<i4", ">i4"});
  check(std::uint64_t{}, {"<u8", ">u8"});
  check(float{}, {"<f4", ">f4"});
  check(double{}, {"<f8", ">f8"});
}

TEST_F(MadeZarrV2, WhatItDoesNotReadIsNamed) {
  const auto expect_refused = [&](const char* key, const Json& value, const char* part) {
    Json metadata = metadata_of("<i2", "C");
    metadata[key] = value;
    write(metadata);
    EXPECT_THAT(refusal(array()), AllOf(HasSubstr(".zarray"), HasSubstr(part)));
  };
  expect_refused("zarr_format", 3, "2 expected, 3 found");
  expect_refused("dtype", "<f16", "\"<f16\" is not supported");
  expect_refused("dtype", "<M8[ns]", "\"<M8[ns]\" is not supported");
  expect_refused("dtype", "|i2", "\"|i2\" is not supported");
  expect_refused("dtype", "<c8", "\"<c8\" is not supported");
  expect_refused("dtype", Json::array({Json::array({"a", "<i2"})}), "is not supported");
  expect_refused("order", "K", "\"C\" or \"F\" expected");
  expect_refused("dimension_separator", "-", "\"/\" or \".\" expected");
  expect_refused("filters", Json::array({{{"id", "delta"}, {"dtype", "<i2"}}}),
                 "filters are not supported, {");
  expect_refused("compressor", {{"id", "lzma"}, {"format", 3}}, "format: 1 (xz) or 2 (lzma)");
  expect_refused("compressor", {{"id", "zfpy"}}, "the compressor \"zfpy\" is not supported");
  expect_refused("shape", {2, 3, 2, 5}, "4 dimensions of 2 x 3 x 2 x 5 samples");
  expect_refused("chunks", {2, 5}, "3 extents expected");
  expect_refused("chunks", {0, 2, 4}, "chunks[0]: an integer from 1");
  expect_refused("fill_value", "x", "fill_value: an integer from -32768 to 32767 expected");
  Json metadata = metadata_of("<i2", "C");
  metadata.erase("compressor");
  write(metadata);
  EXPECT_THAT(refusal(array()), HasSubstr("no \"compressor\" in it"));
}

TEST_F(MadeZarrV2, DamagedChunksAreNamed) {
  for (const char* id : {"zlib", "bz2", "lz4", "zstd", "blosc"}) {
    SCOPED_TRACE(id);
    Json metadata = metadata_of("<i2", "C");
    metadata["compressor"] = {{"id", id}};
    write(metadata);
    for (const std::size_t size : {0U, 3U, 4U, 30U}) {
      write_whole_file(array() / "0.0.0", Bytes(size, std::byte{0x5a}), Durability::rename_only);
      EXPECT_THAT(refusal(array()), HasSubstr("0.0.0"));
    }
  }
}

// Groups of images -------------------------------------------------------------------------------

// The name says which axis a dimension is: read in another order the volume would be mirrored.
TEST_F(MadeZarrV2, AxesOfAnOmeGroupAreTakenByName) {
  const auto group = [&](const Json& axes, const Json& steps, const char* path = "a.zarr") {
    const Json attributes = {
        {"multiscales",
         Json::array({{{"version", "0.4"},
                       {"axes", axes},
                       {"datasets",
                        Json::array({{{"path", path}, {"coordinateTransformations", steps}}})}}})}};
    write_whole_file(directory_ / ".zattrs", as_bytes(attributes.dump()), Durability::rename_only);
  };
  const auto axis = [](const char* name, const char* unit) {
    return Json{{"name", name}, {"type", "space"}, {"unit", unit}};
  };
  const Json steps = Json::array({{{"type", "scale"}, {"scale", {4, 5, 6}}},
                                  {{"type", "translation"}, {"translation", {-1, 0, 2.5}}}});
  const Json metadata = metadata_of("<i2", "F");
  write(metadata);
  write_chunks<std::int16_t>(metadata,
                             {nullptr, [](auto raw) { return Bytes(raw.begin(), raw.end()); }});
  group({axis("z", "micrometer"), axis("y", "micrometer"), axis("x", "micrometer")}, steps);
  for (const auto& named : {array(), directory_.path()}) {
    const auto source = open_zarr(named);
    EXPECT_EQ(source->info().geometry.spacing, (Vec3{6, 5, 4}));
    EXPECT_EQ(source->info().geometry.origin, (Vec3{2.5, 0, -1}));
    EXPECT_EQ(source->info().geometry.unit, "um");
    EXPECT_TRUE(source->info().warnings.empty());
    EXPECT_EQ(read_all<std::int16_t>(*source)[7], 12);  // z 0, y 1, x 2
  }
  group({axis("x", "meter"), axis("y", "meter"), axis("z", "micrometer")}, steps);
  const auto turned = open_zarr(array());
  EXPECT_EQ(turned->info().geometry.size, (Index3{3, 2, 5}));
  EXPECT_EQ(turned->info().geometry.spacing, (Vec3{4, 5, 6}));
  EXPECT_EQ(turned->info().geometry.unit, "");  // they differ
  const auto values = read_all<std::int16_t>(*turned);
  for (int z = 0; z < 4; ++z)
    for (int x = 0; x < 3; ++x)
      EXPECT_EQ(values[static_cast<std::size_t>((z * 2 + 1) * 3 + x)], 100 * x + 10 + z);

  group({"c", "y", "x"}, steps);
  EXPECT_THAT(refusal(array()), HasSubstr("holds 3 channels, of which one is read"));
  group({"z", "y", "x"}, Json::array({{{"type", "scale"}, {"scale", {4, 0, -6}}}}));
  EXPECT_EQ(open_zarr(array())->info().geometry.spacing, (Vec3{6, 1, 4}));
  EXPECT_EQ(open_zarr(array())->info().warnings.size(), 2U);
  group({"z", "y", "x"}, Json::array({{{"type", "affine"}, {"affine", {1}}}}));
  EXPECT_THAT(refusal(directory_.path()), HasSubstr("\"scale\" or \"translation\" expected"));
  group({"z", "y", "x"}, steps, "../else");
  EXPECT_THAT(refusal(directory_.path()), HasSubstr("a path inside the group expected"));
}

// Version 0.5 has it in the attributes of the group's zarr.json.
TEST_F(MadeZarrV2, AnOmeGroupOfVersion3IsOpenedToo) {
  const Json group = {
      {"zarr_format", 3},
      {"node_type", "group"},
      {"attributes",
       {{"ome",
         {{"version", "0.5"},
          {"multiscales",
           Json::array({{{"axes", Json::array({{{"name", "z"}}, {{"name", "y"}}, {{"name", "x"}}})},
                         {"datasets", Json::array({{{"path", "s0"}}, {{"path", "s1"}}})},
                         {"coordinateTransformations",
                          Json::array({{{"type", "scale"}, {"scale", {2, 2, 3}}}})}}})}}}}}};
  write_whole_file(directory_ / "zarr.json", as_bytes(group.dump()), Durability::rename_only);
  write_whole_file(
      directory_ / "s0" / "zarr.json",
      as_bytes(std::string(
          R"({"zarr_format": 3, "node_type": "array", "shape": [3, 2, 5], "data_type": "uint8",
"chunk_grid": {"name": "regular", "configuration": {"chunk_shape": [3, 2, 5]}}, "fill_value": 4,
"chunk_key_encoding": {"name": "default"}, "codecs": [{"name": "bytes"}], "attributes": {}})")),
      Durability::rename_only);
  const auto source = open_zarr(directory_.path());
  EXPECT_EQ(source->info().geometry.size, (Index3{5, 2, 3}));
  EXPECT_EQ(source->info().geometry.spacing, (Vec3{3, 2, 2}));
  EXPECT_EQ(read_all<std::uint8_t>(*source), std::vector<std::uint8_t>(30, 4));
}

TEST(ZarrV2, ARealOmeGroup) {
  VOXWELD_NEEDS_SHARED_DATA("zarr/mni152_axial.ome.zarr");
  const auto group = shared_data("zarr/mni152_axial.ome.zarr");
  const auto source = open_zarr(group);
  const VolumeGeometry& geometry = source->info().geometry;
  EXPECT_EQ(geometry.size, (Index3{207, 256, 1}));  // x, y, z by name
  EXPECT_NEAR(geometry.spacing.x, 0.737463116645813, 1e-12);
  EXPECT_NEAR(geometry.origin.y, -110.76253509521484, 1e-9);
  const auto coarse = open_zarr(group / "scale2/nibabel_converted_image");
  EXPECT_NEAR(coarse->info().geometry.spacing.x, 2.949852466583252, 1e-12);
}

}  // namespace
}  // namespace voxweld
