#include "pipeline/report/png.h"

#include <gtest/gtest.h>
#include <zlib.h>

#include <random>
#include <string>

namespace voxweld {
namespace {

std::uint32_t number_at(const std::vector<std::byte>& bytes, std::size_t at) {
  std::uint32_t number = 0;
  for (std::size_t i = 0; i < 4; ++i)
    number = number << 8 | std::to_integer<std::uint32_t>(bytes.at(at + i));
  return number;
}

struct Chunk {
  std::string type;
  std::vector<std::byte> data;
};
std::vector<Chunk> chunks_of(const std::vector<std::byte>& png) {
  std::vector<Chunk> chunks;
  for (std::size_t at = 8; at < png.size();) {
    const std::size_t length = number_at(png, at);
    const auto begin = png.begin() + static_cast<std::ptrdiff_t>(at + 4);
    Chunk chunk;
    for (auto c = begin; c != begin + 4; ++c) chunk.type += std::to_integer<char>(*c);
    chunk.data.assign(begin + 4, begin + 4 + static_cast<std::ptrdiff_t>(length));
    const auto check =
        crc32(0, reinterpret_cast<const Bytef*>(&*begin), static_cast<uInt>(length + 4));
    EXPECT_EQ(number_at(png, at + 8 + length), check) << chunk.type;
    chunks.push_back(chunk);
    at += 12 + length;
  }
  return chunks;
}

// As a decoder does it: each row begins with how it was filtered.
std::vector<std::uint8_t> decoded(const std::vector<std::byte>& data, const Pixels& like) {
  const auto row = static_cast<std::size_t>(like.width * like.channels);
  const auto pixel = static_cast<std::size_t>(like.channels);
  std::vector<std::uint8_t> rows((row + 1) * static_cast<std::size_t>(like.height)), out;
  uLongf size = rows.size();
  EXPECT_EQ(uncompress(rows.data(), &size, reinterpret_cast<const Bytef*>(data.data()),
                       static_cast<uLong>(data.size())),
            Z_OK);
  EXPECT_EQ(size, rows.size());
  for (std::size_t y = 0; y < static_cast<std::size_t>(like.height); ++y)
    for (std::size_t x = 0; x < row; ++x) {
      const int filter = rows[y * (row + 1)];
      EXPECT_TRUE(filter == 1 || filter == 2);
      const int before = filter == 1 ? (x >= pixel ? out[y * row + x - pixel] : 0)
                                     : (y > 0 ? out[(y - 1) * row + x] : 0);
      out.push_back(static_cast<std::uint8_t>(rows[y * (row + 1) + 1 + x] + before));
    }
  return out;
}

TEST(Png, DecodesToThePixels) {
  std::mt19937 random(3);
  for (const int channels : {1, 3})
    for (const auto& [width, height] : {std::pair{1, 1}, std::pair{17, 5}, std::pair{64, 40}}) {
      Pixels pixels{width, height, channels, {}};
      for (int i = 0; i < width * height * channels; ++i)
        pixels.data.push_back(
            static_cast<std::uint8_t>(i % 2 == 0 ? i : static_cast<int>(random())));
      const auto chunks = chunks_of(png_bytes(pixels));
      ASSERT_EQ(chunks.size(), 3u);
      EXPECT_EQ(chunks[0].type + chunks[1].type + chunks[2].type, "IHDRIDATIEND");
      EXPECT_EQ(number_at(chunks[0].data, 0), static_cast<std::uint32_t>(width));
      EXPECT_EQ(number_at(chunks[0].data, 4), static_cast<std::uint32_t>(height));
      EXPECT_EQ(std::to_integer<int>(chunks[0].data[8]), 8);
      EXPECT_EQ(std::to_integer<int>(chunks[0].data[9]), channels == 3 ? 2 : 0);
      EXPECT_EQ(decoded(chunks[1].data, pixels), pixels.data);
    }
}

TEST(Png, AnAddressHoldsIt) {
  const std::string address = png_address({1, 1, 1, {200}});
  EXPECT_EQ(address.rfind("data:image/png;base64,iVBORw0KGgo", 0), 0u) << address;
}

}  // namespace
}  // namespace voxweld
