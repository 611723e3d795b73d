// Stacks and corner cases written by other programs.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numeric>

#include "storage/image/stack_source.h"
#include "storage/support/error.h"
#include "tests/support/error_text.h"
#include "tests/support/temp_directory.h"

namespace voxweld {
namespace {

using ::testing::HasSubstr;

std::string tiff(const std::string& name) {
  return testing::shared_data("tiff/" + name).string();
}

template <class T>
std::vector<T> read_all(const SampleSource& source) {
  const Box3 whole{{0, 0, 0}, source.info().geometry.size};
  std::vector<T> samples(static_cast<std::size_t>(whole.count()));
  source.read(whole, reinterpret_cast<std::byte*>(samples.data()));
  return samples;
}

std::string data_refusal(const std::string& name) {
  return testing::error_text<Error>([&] { open_stack({tiff(name), {}, {}}); });
}

TEST(RealStacks, MicroCt) {
  VOXWELD_NEEDS_SHARED_DATA("tiff/puma");
  for (const auto& [name, size] : {std::pair<std::string, std::int64_t>{"100_fiberform", 100},
                                   {"50_artfibers", 50},
                                   {"small_weave", 150}}) {
    const auto source = open_stack({tiff("puma/" + name + ".tif"), {}, {}});
    EXPECT_EQ(source->info().geometry.size, splat(size)) << name;
    EXPECT_EQ(source->info().geometry.spacing, (Vec3{1, 1, 1})) << name;
    const auto samples = read_all<std::uint8_t>(*source);
    const auto [lo, hi] = std::minmax_element(samples.begin(), samples.end());
    EXPECT_GT(*hi - *lo, 50) << name;
  }
}

// 256 samples counting up, stored in every bit depth, order and compression. The name says the
// depth; the reader has to give back the count, whatever the storage.
TEST(RealStacks, CountUpInEveryStorage) {
  VOXWELD_NEEDS_SHARED_DATA("tiff/image_tiff/seq");
  const auto expect_count = [&](const std::string& name, std::uint64_t modulus, auto tag) {
    using T = typename decltype(tag)::type;
    const auto source = open_stack({tiff("image_tiff/seq/" + name + ".tiff"), {}, {}});
    const auto samples = read_all<T>(*source);
    ASSERT_EQ(samples.size(), 256U) << name;
    for (std::size_t i = 0; i < samples.size(); ++i)
      ASSERT_EQ(samples[i], static_cast<T>(i % modulus)) << name << " at " << i;
  };
  for (const char* name :
       {"seq-1c-8b-bigendian-20f3db0c", "seq-1c-8b-bigtiff-20f3db0c", "seq-1c-8b-deflate-20f3db0c",
        "seq-1c-8b-lzw-20f3db0c", "seq-1c-8b-lzw-hpredict-20f3db0c",
        "seq-1c-8b-multistrip-20f3db0c", "seq-1c-8b-packbits-20f3db0c", "seq-1c-8b-tiled-20f3db0c",
        "seq-1c-8b-tiled-lzw-20f3db0c", "seq-1c-8b-tiled-bigtiff-20f3db0c",
        "seq-1c-8b-tiled-deflate-20f3db0c"})
    expect_count(name, 256, SampleTag<std::uint8_t>{});
  for (const char* name :
       {"seq-1c-16b-bigendian-68f373a0", "seq-1c-16b-deflate-68f373a0", "seq-1c-16b-lzw-68f373a0",
        "seq-1c-16b-multistrip-68f373a0", "seq-1c-16b-tiled-68f373a0", "seq-1c-14b-e883657f",
        "seq-1c-12b-47c39b31", "seq-1c-10b-6d739fa2", "seq-1c-14b-hpredict-e883657f",
        "seq-1c-14b-miniswhite-e883657f", "seq-1c-12b-miniswhite-47c39b31",
        "seq-1c-10b-miniswhite-6d739fa2"})
    expect_count(name, 65536, SampleTag<std::uint16_t>{});
  for (const char* name : {"seq-1c-24b-072a9dc9", "seq-1c-24b-miniswhite-072a9dc9"})
    expect_count(name, 1ULL << 32, SampleTag<std::uint32_t>{});
  expect_count("seq-1c-1b-71f6a21a", 2, SampleTag<std::uint8_t>{});
  expect_count("seq-1c-1b-miniswhite-71f6a21a", 2, SampleTag<std::uint8_t>{});
  expect_count("seq-1c-1b-fax3-71f6a21a", 2, SampleTag<std::uint8_t>{});
  expect_count("seq-1c-2b-58b25f76", 4, SampleTag<std::uint8_t>{});
  expect_count("seq-1c-4b-fb92dcae", 16, SampleTag<std::uint8_t>{});
  expect_count("seq-1c-4b-miniswhite-fb92dcae", 16, SampleTag<std::uint8_t>{});
  expect_count("seq-1c-6b-miniswhite-79cafbb6", 64, SampleTag<std::uint8_t>{});
}

TEST(RealStacks, TilesAtTheEdge) {
  VOXWELD_NEEDS_SHARED_DATA("tiff/image_tiff");
  const auto source = open_stack({tiff("image_tiff/tiled-oversize-gray-i8.tif"), {}, {}});
  EXPECT_EQ(source->info().geometry.size, (Index3{499, 374, 1}));
  const auto whole = read_all<std::int8_t>(*source);
  std::vector<std::int8_t> band(499 * 10);
  source->read({{0, 300, 0}, {499, 310, 1}}, reinterpret_cast<std::byte*>(band.data()));
  EXPECT_TRUE(std::equal(band.begin(), band.end(), whole.begin() + 300 * 499));
}

TEST(RealStacks, HalfFloatsBecomeFloats) {
  VOXWELD_NEEDS_SHARED_DATA("tiff/image_tiff");
  const auto plain = open_stack({tiff("image_tiff/random-fp16.tiff"), {}, {}});
  const auto predicted = open_stack({tiff("image_tiff/random-fp16-pred3.tiff"), {}, {}});
  EXPECT_EQ(plain->info().type, SampleType::f32);
  EXPECT_EQ(read_all<float>(*plain), read_all<float>(*predicted));
}

TEST(RealStacks, RefusesWhatIsNotOneChannel) {
  VOXWELD_NEEDS_SHARED_DATA("tiff/image_tiff");
  EXPECT_THAT(data_refusal("image_tiff/rgb-3c-8b.tiff"), HasSubstr("has 3 channels: 0 (red)"));
  EXPECT_THAT(data_refusal("image_tiff/cmyk-4c-8b.tiff"), HasSubstr("3 (black), 4"));
  EXPECT_THAT(data_refusal("image_tiff/minisblack-2c-8b-alpha.tiff"), HasSubstr("1 (alpha)"));
  EXPECT_THAT(data_refusal("image_tiff/logluv-3c-16b.tiff"), HasSubstr("LogLuv"));
}

TEST(RealStacks, GivesTheIndicesOfPalettes) {
  VOXWELD_NEEDS_SHARED_DATA("tiff/image_tiff");
  const auto source = open_stack({tiff("image_tiff/palette-1c-4b.tiff"), {}, {}});
  EXPECT_EQ(source->info().type, SampleType::u8);
  EXPECT_THAT(source->info().warnings, ::testing::Contains(HasSubstr("its indices are read")));
  const auto samples = read_all<std::uint8_t>(*source);
  EXPECT_LT(*std::max_element(samples.begin(), samples.end()), 16);
}

// Nothing here may crash or hang, whatever it is.
TEST(RealStacks, EveryFileOpensOrIsRefused) {
  VOXWELD_NEEDS_SHARED_DATA("tiff/image_tiff");
  std::size_t opened = 0;
  for (const auto& entry :
       std::filesystem::recursive_directory_iterator(testing::shared_data("tiff/image_tiff"))) {
    if (!entry.is_regular_file()) continue;
    try {
      const auto source = open_stack({entry.path().string()});
      const VolumeInfo& info = source->info();
      std::vector<std::byte> out(
          static_cast<std::size_t>(info.geometry.size.x * info.geometry.size.y *
                                   info.geometry.size.z) *
          sample_bytes(info.type));
      source->read({{0, 0, 0}, info.geometry.size}, out.data());
      ++opened;
    } catch (const Error& error) {
      EXPECT_THAT(error.what(), HasSubstr(entry.path().filename().string()));
    }
  }
  EXPECT_GT(opened, 50U);
}

}  // namespace
}  // namespace voxweld
