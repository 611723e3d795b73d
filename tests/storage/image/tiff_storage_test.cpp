// TIFF files as few programs write them: odd depths, damage, ImageJ's form of files over 4 GiB.
#include <fcntl.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <random>

#include "storage/support/byte_order.h"
#include "tests/storage/image/tiff_writer.h"
#include "tests/storage/volumes/known_volume.h"

namespace voxweld::testing {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;

// Values of so many bits, one behind the other from the highest bit on; rows start at a byte.
Bytes packed_rows(const std::vector<std::uint64_t>& values, std::size_t width, int bits) {
  Bytes bytes;
  for (std::size_t row = 0; row < values.size(); row += width) {
    int used = 8;
    for (std::size_t i = row; i < row + width; ++i)
      for (int bit = bits - 1; bit >= 0; --bit) {
        if (used == 8) {
          bytes.push_back(std::byte{0});
          used = 0;
        }
        if ((values[i] >> bit & 1) != 0) bytes.back() |= std::byte{0x80} >> used;
        ++used;
      }
  }
  return bytes;
}

TEST(TiffDepths, AreAllReadWithoutStretching) {
  const TempDirectory directory;
  std::mt19937_64 random(4);
  for (int bits = 1; bits <= 32; ++bits)
    for (const bool with_sign : {false, true}) {
      if (bits == 8 || bits == 16 || bits == 32) continue;
      SCOPED_TRACE(fmt::format("{} bits, {}", bits, with_sign ? "signed" : "unsigned"));
      std::vector<std::uint64_t> values(13 * 7);
      for (std::uint64_t& value : values) value = random() & ((std::uint64_t{1} << bits) - 1);
      TiffPage page;
      page.width = 13;
      page.height = 7;
      page.bits = static_cast<std::uint16_t>(bits);
      page.deflate = bits % 2 == 0;
      page.strip_rows = 3;
      const SampleType types[] = {SampleType::u8, SampleType::u16, SampleType::u32,
                                  SampleType::i8, SampleType::i16, SampleType::i32};
      page.type = types[(bits <= 8 ? 0 : bits <= 16 ? 1 : 2) + (with_sign ? 3 : 0)];
      page.data = packed_rows(values, 13, bits);
      write_tiff(directory / "a.tif", {page});
      const auto source = open_path(directory / "a.tif");
      ASSERT_EQ(source->info().type, page.type);
      const Bytes read = read_box(*source, {{}, {13, 7, 1}});
      dispatch_sample_type(page.type, [&](auto tag) {
        using T = typename decltype(tag)::type;
        const auto low = static_cast<std::int64_t>(std::uint64_t{1} << bits);
        for (std::size_t i = 0; i < values.size(); ++i) {
          T value{};
          std::memcpy(&value, read.data() + i * sizeof(T), sizeof(T));
          auto expected = static_cast<std::int64_t>(values[i]);
          if (with_sign && expected >= low / 2) expected -= low;
          ASSERT_EQ(static_cast<std::int64_t>(value), expected) << i;
        }
      });
    }
}

TiffPage counted_page(std::uint32_t width, std::uint32_t height, int first) {
  std::vector<std::uint16_t> samples(std::size_t{width} * height);
  for (std::size_t i = 0; i < samples.size(); ++i)
    samples[i] = static_cast<std::uint16_t>(i * 7 + static_cast<std::size_t>(first));
  return tiff_page(width, height, SampleType::u16, samples);
}

// Either an error or what the file says: no crash, and nothing that takes all memory.
TEST(TiffDamage, IsAnErrorOrHarmless) {
  const VolumeFolder folder;
  std::mt19937_64 random(8);
  for (const bool deflate : {false, true}) {
    std::vector<TiffPage> pages;
    for (int z = 0; z < 3; ++z) {
      pages.push_back(counted_page(16, 12, z));
      pages.back().deflate = deflate;
      pages.back().strip_rows = 5;
    }
    pages[0].description = "ImageJ=1.53t\nimages=3\nslices=3\nspacing=2\n";
    write_tiff(folder / "whole.tif", pages, deflate);
    const Bytes whole = read_whole_file(folder / "whole.tif");
    for (int i = 0; i < 1500; ++i) {
      Bytes changed = whole;
      for (std::uint64_t flips = 1 + random() % 3; flips > 0; --flips)
        changed[random() % changed.size()] = static_cast<std::byte>(random() % 256);
      folder.complaint("a.tif", changed);
    }
  }
}

// Of damaged deflate streams libtiff lets those pass that go on behind the strip's end: it then
// does not look at their checksum. All others are found.
TEST(TiffDamage, InStripsIsFoundByTheirChecksum) {
  const VolumeFolder folder;
  TiffPage page = counted_page(64, 64, 1);
  page.deflate = true;
  page.strip_rows = 64;
  write_tiff(folder / "whole.tif", {page});
  const Bytes whole = read_whole_file(folder / "whole.tif");
  int damaged = 0, found = 0;
  for (std::size_t at = 60; at < 600; at += 11, ++damaged) {
    Bytes changed = whole;
    changed[at] ^= std::byte{0x10};
    if (!folder.complaint("a.tif", changed).empty()) ++found;
  }
  EXPECT_GT(found, damaged * 8 / 10);
}

TEST(TiffDamage, SizesThatTheFileCannotHoldAreRefused) {
  const VolumeFolder folder;
  for (const bool deflate : {false, true}) {
    TiffPage page = counted_page(16, 12, 0);
    page.deflate = deflate;
    write_tiff(folder / "whole.tif", {page});
    Bytes changed = read_whole_file(folder / "whole.tif");
    // The entries of width and height: tag, type, count 1, then the value.
    for (std::size_t i = 8; i + 12 <= changed.size(); ++i) {
      const auto tag = load_as<std::uint16_t>(changed.data(), i, std::endian::little);
      const bool entry = load_as<std::uint16_t>(changed.data(), i + 2, std::endian::little) == 4 &&
                         load_as<std::uint32_t>(changed.data(), i + 4, std::endian::little) == 1;
      const std::uint32_t huge = 2'000'000'000;
      if (entry && (tag == 256 || tag == 257 || tag == 278))
        std::memcpy(changed.data() + i + 8, &huge, sizeof huge);
    }
    EXPECT_THAT(folder.complaint("a.tif", changed), HasSubstr("a.tif"));
  }
}

// Over 4 GiB ImageJ writes one directory, and all images behind each other.
TEST(ImagejFiles, OfOneDirectoryAreReadInPlace) {
  const TempDirectory directory;
  const std::filesystem::path path = directory / "big.tif";
  constexpr std::uint32_t side = 1024;
  constexpr std::uint64_t image = std::uint64_t{2} * side * side, images = 2400;
  TiffPage page = counted_page(side, side, 0);
  page.description = fmt::format(
      "ImageJ=1.53t\nimages={}\nchannels=2\nslices=1200\nhyperstack=true\nunit=um\nspacing=3\n",
      images);
  page.resolution = 2;
  write_tiff(path, {page});
  const Bytes head = read_whole_file(path);
  const auto first = static_cast<std::uint64_t>(
      std::search(head.begin(), head.end(), page.data.begin(), page.data.end()) - head.begin());
  std::error_code error;
  std::filesystem::resize_file(path, first + images * image, error);
  if (error) GTEST_SKIP() << "needs a file system with sparse files of 5 GiB";
  const std::uint16_t mark = 0x1234;
  const int file = open(path.c_str(), O_WRONLY);
  ASSERT_EQ(pwrite(file, &mark, sizeof mark,
                   static_cast<off_t>(first + (2 * 1100 + 1) * image + 2 * (5 * side + 7))),
            2);
  close(file);

  EXPECT_THAT(complaint(path), HasSubstr("has 2 channels"));
  InputSpec spec{.path = path.string()};
  spec.select.channel = 1;
  const auto source = open_volume(spec);
  const VolumeInfo& info = source->info();
  EXPECT_EQ(info.access, Access::box);
  EXPECT_EQ(info.geometry.size, (Index3{side, side, 1200}));
  EXPECT_EQ(info.geometry.spacing, (Vec3{0.5, 0.5, 3}));
  EXPECT_EQ(info.geometry.unit, "um");
  const Bytes here = read_box(*source, {{7, 5, 1100}, {8, 6, 1101}});
  EXPECT_EQ(load_as<std::uint16_t>(here.data(), 0, std::endian::little), mark);
  std::filesystem::resize_file(path, first + images * image - 1);
  EXPECT_THAT(complaint(spec), HasSubstr("has room for 2399"));
}

TEST(Survey, ShowsTheFirstAndListsTheChoices) {
  const TempDirectory directory;
  std::vector<TiffPage> pages;
  for (int i = 0; i < 6; ++i) pages.push_back(counted_page(4, 3, i));
  pages[0].description = "ImageJ=1.53t\nimages=6\nchannels=2\nslices=3\nhyperstack=true\n";
  write_tiff(directory / "a.tif", pages);
  InputSpec spec{.path = (directory / "a.tif").string(), .survey = true};
  const auto source = open_volume(spec);
  EXPECT_THAT(source->info().warnings, Contains(HasSubstr("has 2 channels: 0, 1; shown is")));
  ASSERT_EQ(source->info().choices.size(), 2U);
  EXPECT_EQ(source->info().choices[0].selector, "channel");
  EXPECT_TRUE(source->info().choices[0].chosen);
  EXPECT_FALSE(source->info().choices[1].chosen);
  EXPECT_EQ(read_box(*source, {{0, 0, 1}, {4, 3, 2}}), pages[2].data);
  spec.select.dataset = "a";
  EXPECT_THAT(complaint(spec), HasSubstr("only OME-TIFF files hold"));
  spec.select = {.channel = 1, .time = 1};
  EXPECT_THAT(complaint(spec), HasSubstr("has 1 time; input.time (--time) is 1"));
}

}  // namespace
}  // namespace voxweld::testing
