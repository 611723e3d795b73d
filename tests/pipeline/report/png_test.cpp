#include "pipeline/report/png.h"

#include <gtest/gtest.h>
#include <png.h>

#include <random>
#include <string>

namespace voxweld {
namespace {

Pixels decoded(const std::vector<std::byte>& bytes, int channels) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  EXPECT_NE(png_image_begin_read_from_memory(&image, bytes.data(), bytes.size()), 0);
  EXPECT_EQ(image.format,
            static_cast<png_uint_32>(channels == 3 ? PNG_FORMAT_RGB : PNG_FORMAT_GRAY));
  Pixels pixels{static_cast<int>(image.width), static_cast<int>(image.height), channels, {}};
  pixels.data.resize(PNG_IMAGE_SIZE(image));
  EXPECT_NE(png_image_finish_read(&image, nullptr, pixels.data.data(), 0, nullptr), 0);
  return pixels;
}

TEST(Png, DecodesToThePixels) {
  std::mt19937 random(3);
  for (const int channels : {1, 3})
    for (const auto& [width, height] : {std::pair{1, 1}, std::pair{17, 5}, std::pair{64, 40}}) {
      Pixels pixels{width, height, channels, {}};
      for (int i = 0; i < width * height * channels; ++i)
        pixels.data.push_back(
            static_cast<std::uint8_t>(i % 2 == 0 ? i : static_cast<int>(random())));
      const Pixels read = decoded(png_bytes(pixels), channels);
      EXPECT_EQ(read.width, width);
      EXPECT_EQ(read.height, height);
      EXPECT_EQ(read.data, pixels.data);
    }
}

TEST(Png, AnAddressHoldsIt) {
  const std::string address = png_address({1, 1, 1, {200}});
  EXPECT_EQ(address.rfind("data:image/png;base64,iVBORw0KGgo", 0), 0u) << address;
}

}  // namespace
}  // namespace voxweld
