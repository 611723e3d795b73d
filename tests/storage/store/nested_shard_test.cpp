// Shards within shards, transposed ones, codecs of numcodecs, and how often chunks are decoded.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>
#include <random>

#include "storage/store/byte_store.h"
#include "storage/store/chunk_reader.h"
#include "storage/store/open_zarr.h"
#include "storage/support/error.h"
#include "storage/support/file_io.h"
#include "tests/storage/store/array_writers.h"
#include "tests/storage/store/zarr_reading.h"
#include "tests/support/temp_directory.h"

namespace voxweld {
namespace {

using ::testing::HasSubstr;
using testing::read_all;
using testing::refusal;
using Json = nlohmann::json;
using Triple = std::array<int, 3>;  // z, y, x, or whatever order the dimensions are in

Json codec_entry(const char* name, Json configuration) {
  return Json{{"name", name}, {"configuration", std::move(configuration)}};
}
const Json little = codec_entry("bytes", {{"endian", "little"}});

Json sharding(const Triple& chunk, Json codecs, bool at_end) {
  return codec_entry("sharding_indexed", {{"chunk_shape", chunk},
                                          {"codecs", std::move(codecs)},
                                          {"index_codecs", {little, {{"name", "crc32c"}}}},
                                          {"index_location", at_end ? "end" : "start"}});
}

std::uint16_t value_at(int z, int y, int x) {
  return static_cast<std::uint16_t>(400 * z + 20 * y + x);
}

// f(place, C order) of each.
template <class F>
void each_of(const Triple& size, const F& f) {
  for (int a = 0; a < size[0]; ++a)
    for (int b = 0; b < size[1]; ++b)
      for (int c = 0; c < size[2]; ++c) f(Triple{a, b, c});
}

// One way to store a volume of 8 x 16 x 16 samples (z, y, x) in files of 8 x 8 x 8.
struct Form {
  Triple outer{0, 1, 2}, inner{0, 1, 2};  // transpose before each sharding_indexed
  bool nested = true, outer_at_end = true, inner_at_end = true;
};

class MadeShards : public ::testing::Test {
 protected:
  static constexpr Triple middle{4, 8, 4}, smallest{4, 2, 2};  // as the transposed see them

  void write(const Form& form) {
    Json inner = Json::array({little});
    if (form.nested)
      inner = {codec_entry("transpose", {{"order", form.inner}}),
               sharding(smallest, Json::array({little}), form.inner_at_end)};
    const Json codecs = {codec_entry("transpose", {{"order", form.outer}}),
                         sharding(middle, inner, form.outer_at_end)};
    const Json metadata = {
        {"zarr_format", 3},
        {"node_type", "array"},
        {"shape", {8, 16, 16}},
        {"data_type", "uint16"},
        {"chunk_grid", {{"name", "regular"}, {"configuration", {{"chunk_shape", {8, 8, 8}}}}}},
        {"chunk_key_encoding", {{"name", "default"}}},
        {"fill_value", 9},
        {"codecs", codecs},
        {"attributes", Json::object()}};
    write_text("zarr.json", metadata.dump());
    for (int y = 0; y < 2; ++y)
      for (int x = 0; x < 2; ++x) write_text(fmt::format("c/0/{}/{}", y, x), shard(form, y, x));
  }
  // The place of the array at which dimension i of the transposed runs along order[i].
  static std::string shard(const Form& form, int file_y, int file_x) {
    std::vector<std::string> pieces;
    each_of({8 / middle[0], 8 / middle[1], 8 / middle[2]}, [&](const Triple& piece) {
      const auto sample = [&](const Triple& in_piece) {  // of the outer transposed
        Triple place{};
        for (std::size_t i = 0; i < 3; ++i)
          place[static_cast<std::size_t>(form.outer[i])] = piece[i] * middle[i] + in_piece[i];
        return testing::number_bytes(
            value_at(place[0], 8 * file_y + place[1], 8 * file_x + place[2]), 2);
      };
      pieces.push_back(form.nested ? nested(form, sample) : plain(middle, sample));
    });
    return testing::shard_of(pieces, form.outer_at_end);
  }
  template <class Sample>
  static std::string plain(const Triple& size, const Sample& sample) {
    std::string bytes;
    each_of(size, [&](const Triple& at) { bytes += sample(at); });
    return bytes;
  }
  template <class Sample>
  static std::string nested(const Form& form, const Sample& sample) {
    Triple turned{}, grid{};
    for (std::size_t i = 0; i < 3; ++i) {
      turned[i] = middle[static_cast<std::size_t>(form.inner[i])];
      grid[i] = turned[i] / smallest[i];
    }
    std::vector<std::string> pieces;
    each_of(grid, [&](const Triple& piece) {
      pieces.push_back(plain(smallest, [&](const Triple& at) {
        Triple place{};
        for (std::size_t i = 0; i < 3; ++i)
          place[static_cast<std::size_t>(form.inner[i])] = piece[i] * smallest[i] + at[i];
        return sample(place);
      }));
    });
    return testing::shard_of(pieces, form.inner_at_end);
  }

  void write_text(const std::string& key, const std::string& text) const {
    write_whole_file(array() / key, as_bytes(text), Durability::rename_only);
  }
  std::filesystem::path array() const { return directory_ / "a.zarr"; }
  void expect_samples() const {
    const auto source = open_zarr(array());
    const auto values = read_all<std::uint16_t>(*source);
    ASSERT_EQ(values.size(), 8U * 16 * 16);
    for (int z = 0; z < 8; ++z)
      for (int y = 0; y < 16; ++y)
        for (int x = 0; x < 16; ++x)
          ASSERT_EQ(values[static_cast<std::size_t>((z * 16 + y) * 16 + x)], value_at(z, y, x))
              << z << ' ' << y << ' ' << x;
    const auto part = testing::read_box(*source, {{7, 3, 2}, {9, 9, 3}});
    std::uint16_t last = 0;
    std::memcpy(&last, part.data() + part.size() - 2, 2);
    EXPECT_EQ(last, value_at(2, 8, 8));
  }

  const testing::TempDirectory directory_;
};

TEST_F(MadeShards, NestedAndTransposed) {
  const Triple as_is{0, 1, 2};
  for (const Triple& outer : {as_is, Triple{1, 0, 2}, Triple{2, 0, 1}, Triple{1, 2, 0}})
    for (const Triple& inner : {as_is, Triple{0, 2, 1}, Triple{2, 0, 1}})
      for (const bool nested : {false, true})
        for (const bool at_end : {true, false}) {
          // The smallest must divide what they are cut from.
          SCOPED_TRACE(fmt::format("{} {} {} {} {} {} nested {} end {}", outer[0], outer[1],
                                   outer[2], inner[0], inner[1], inner[2], nested, at_end));
          write({outer, inner, nested, at_end, !at_end});
          expect_samples();
        }
}

TEST_F(MadeShards, DamageIsNamedAndMissingPiecesAreFill) {
  write({});
  const std::string whole = shard({}, 0, 0);
  for (std::size_t size = 0; size < whole.size(); size += 7) {
    write_text("c/0/0/0", whole.substr(0, size));
    ASSERT_THAT(refusal(array()), HasSubstr("c/0/0/0")) << size;
  }
  // An index of the inner shards: each byte of it counts.
  const std::size_t index = whole.size() - 16 * 4 - 4 - 20;
  for (std::size_t at = index; at < whole.size(); ++at) {
    std::string changed = whole;
    changed[at] = static_cast<char>(changed[at] ^ 0x40);
    write_text("c/0/0/0", changed);
    ASSERT_NE(refusal(array()), "accepted") << at;
  }
  write_text("c/0/0/0", testing::shard_of({"", "", "", ""}));
  EXPECT_EQ(read_all<std::uint16_t>(*open_zarr(array()))[0], 9);
}

// Chunks are decoded once for neighbouring boxes, as far as they are kept.
TEST_F(MadeShards, ChunksThatBoxesShareAreDecodedOnce) {
  write({});
  const StoreFolder folder(folder_store(array()));
  const ChunkReader reader(read_zarr_array(folder, {}), folder, Ownership::theirs);
  std::vector<std::byte> out(6 * 6 * 6 * 2);
  const auto pass = [&] {
    for (std::int64_t x = 0; x + 6 <= 16; x += 2)
      reader.read({{x, 2, 1}, {x + 6, 8, 7}}, out.data());
  };
  pass();
  // 4 x 2 x 2 samples each: 2 x 3 x 8 chunks hold all of these boxes.
  EXPECT_EQ(reader.decoded(), 48U);
  pass();
  EXPECT_EQ(reader.decoded(), 48U);
  const ChunkReader ours(read_zarr_array(folder, {}), folder, Ownership::ours);
  ours.read({{0, 2, 1}, {6, 8, 7}}, out.data());
  ours.read({{0, 2, 1}, {6, 8, 7}}, out.data());
  EXPECT_EQ(ours.decoded(), 2 * 2 * 3 * 3U);
  EXPECT_GT(reader.largest_decode(), ours.largest_decode());
}

TEST_F(MadeShards, MoreThanFourDeepIsRefused) {
  write({});
  Json metadata = Json::parse(read_text_file(array() / "zarr.json"));
  Json codecs = Json::array({little});
  for (int i = 0; i < 5; ++i) codecs = Json::array({sharding({8, 8, 8}, codecs, true)});
  metadata["codecs"] = codecs;
  write_text("zarr.json", metadata.dump());
  EXPECT_THAT(refusal(array()), HasSubstr("more than 4 deep"));
}

}  // namespace
}  // namespace voxweld
