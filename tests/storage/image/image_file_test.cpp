#include "storage/image/image_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <numeric>

#include "storage/support/error.h"
#include "storage/support/file_io.h"
#include "tests/storage/image/tiff_writer.h"
#include "tests/support/error_text.h"
#include "tests/support/temp_directory.h"

// OpenImageIO's PNG reader jumps over the destructor of its message when a file ends early; asked
// for by the leak sanitizer where it is built in.
extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions() {
  return "leak:ImageInput::geterror";
}

namespace voxweld {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::tiff_page;
using testing::TiffPage;
using testing::write_tiff;

template <class T>
std::vector<T> read_page(ImageFile& file, std::size_t page = 0) {
  const ImagePage facts = file.page(page);
  std::vector<T> samples(static_cast<std::size_t>(facts.width * facts.height * facts.channels));
  file.read_rows({.page = static_cast<int>(page), .y0 = 0, .y1 = facts.height},
                 std::as_writable_bytes(std::span(samples)));
  return samples;
}

template <class T>
void expect_round_trip(SampleType type, const std::vector<T>& samples) {
  const testing::TempDirectory directory;
  write_tiff(directory / "a.tif",
             {tiff_page(static_cast<std::uint32_t>(samples.size() / 2), 2, type, samples)});
  ImageFile file(directory / "a.tif");
  EXPECT_EQ(file.page(0).type, type);
  EXPECT_EQ(read_page<T>(file), samples) << sample_type_name(type);
}

TEST(ImageFile, GivesSamplesAsTheyAre) {
  expect_round_trip<std::uint8_t>(SampleType::u8, {0, 1, 127, 128, 254, 255});
  expect_round_trip<std::int8_t>(SampleType::i8, {0, 1, 127, -128, -2, -1});
  expect_round_trip<std::uint16_t>(SampleType::u16, {0, 1, 255, 256, 65534, 65535});
  expect_round_trip<std::int16_t>(SampleType::i16, {0, -1, 32767, -32768, 300, -300});
  expect_round_trip<std::uint32_t>(SampleType::u32, {0, 1, 4294967295U, 70000, 16777217, 5});
  expect_round_trip<std::int32_t>(SampleType::i32, {0, -1, 2147483647, -2147483648, 16777217, 5});
  expect_round_trip<float>(SampleType::f32, {0.0F, -1.5F, 1e30F, 1e-30F, 3.0F, -1000.25F});
  expect_round_trip<double>(SampleType::f64, {0.0, -1.5, 1e300, 1e-300, 0.1, 12345.678});
}

TEST(ImageFile, ReadsBandsOfStrips) {
  const testing::TempDirectory directory;
  std::vector<std::uint16_t> samples(7 * 20);
  std::iota(samples.begin(), samples.end(), std::uint16_t{1000});
  for (const bool deflate : {false, true}) {
    TiffPage page = tiff_page(7, 20, SampleType::u16, samples);
    page.strip_rows = 6;
    page.deflate = deflate;
    write_tiff(directory / "a.tif", {page});
    ImageFile file(directory / "a.tif");
    EXPECT_EQ(file.page(0).strip_rows, 6);
    for (const auto& [y0, y1] : {std::pair{0, 4}, {4, 13}, {13, 20}, {3, 5}, {0, 20}, {19, 20}}) {
      std::vector<std::uint16_t> band(static_cast<std::size_t>(y1 - y0) * 7);
      file.read_rows({.y0 = y0, .y1 = y1}, std::as_writable_bytes(std::span(band)));
      EXPECT_TRUE(std::equal(band.begin(), band.end(), samples.begin() + y0 * 7)) << y0;
    }
  }
}

TEST(ImageFile, WidensOddBitDepthsWithoutRescaling) {
  const testing::TempDirectory directory;
  // Four 12-bit samples: 0x001, 0xABC, 0xFFF, 0x800, most significant bit first.
  TiffPage page =
      tiff_page<std::uint8_t>(4, 1, SampleType::u16, {0x00, 0x1A, 0xBC, 0xFF, 0xF8, 0x00});
  page.bits = 12;
  write_tiff(directory / "12.tif", {page});
  ImageFile twelve(directory / "12.tif");
  EXPECT_EQ(twelve.page(0).stored_bits, 12);
  EXPECT_THAT(read_page<std::uint16_t>(twelve), ElementsAre(0x001, 0xABC, 0xFFF, 0x800));

  TiffPage mask = tiff_page<std::uint8_t>(8, 1, SampleType::u8, {0b10110001});
  mask.bits = 1;
  write_tiff(directory / "1.tif", {mask});
  ImageFile one(directory / "1.tif");
  EXPECT_THAT(read_page<std::uint8_t>(one), ElementsAre(1, 0, 1, 1, 0, 0, 0, 1));
}

TEST(ImageFile, TurnsWhiteIsZeroRound) {
  const testing::TempDirectory directory;
  TiffPage bytes = tiff_page<std::uint8_t>(3, 1, SampleType::u8, {0, 10, 255});
  TiffPage words = tiff_page<std::uint16_t>(3, 1, SampleType::u16, {0, 10, 65535});
  bytes.photometric = words.photometric = 0;
  write_tiff(directory / "8.tif", {bytes});
  write_tiff(directory / "16.tif", {words});
  ImageFile eight(directory / "8.tif"), sixteen(directory / "16.tif");
  EXPECT_THAT(read_page<std::uint8_t>(eight), ElementsAre(255, 245, 0));
  EXPECT_THAT(read_page<std::uint16_t>(sixteen), ElementsAre(65535, 65525, 0));
}

TEST(ImageFile, ReadsPagesOfBigTiffInAnyOrder) {
  const testing::TempDirectory directory;
  std::vector<TiffPage> pages;
  for (std::uint8_t p = 0; p < 5; ++p)
    pages.push_back(
        tiff_page<std::uint8_t>(2, 1, SampleType::u8, {p, static_cast<std::uint8_t>(p + 10)}));
  write_tiff(directory / "a.tif", pages, true);
  ImageFile file(directory / "a.tif");
  ASSERT_EQ(file.page_count(), 5U);
  for (const std::size_t p : {3U, 0U, 4U, 4U, 1U})
    EXPECT_THAT(read_page<std::uint8_t>(file, p), ElementsAre(p, p + 10));
}

std::string failure_to_open(const std::filesystem::path& path) {
  return testing::error_text<Error>([&] { ImageFile file(path); });
}

TEST(ImageFile, NamesFilesThatAreNoImages) {
  const testing::TempDirectory directory;
  std::ofstream(directory / "a.tif") << "certainly not a TIFF";
  std::ofstream(directory / "empty.tif");
  std::ofstream(directory / "a.xyz") << "no known kind";
  EXPECT_THAT(
      failure_to_open(directory / "a.tif"),
      AllOf(HasSubstr("a.tif"), HasSubstr("cannot be read as an image"), HasSubstr("20 bytes")));
  EXPECT_THAT(failure_to_open(directory / "empty.tif"), HasSubstr("0 bytes"));
  EXPECT_THAT(failure_to_open(directory / "a.xyz"), HasSubstr("cannot be read as an image"));
  EXPECT_THROW(ImageFile(directory / "none.tif"), StorageError);
}

// Cut anywhere, a file either fails to open or fails to read: never wrong samples.
TEST(ImageFile, FindsEveryTruncation) {
  const testing::TempDirectory directory;
  std::vector<std::uint16_t> samples(16 * 16);
  std::iota(samples.begin(), samples.end(), std::uint16_t{1});
  for (const bool deflate : {false, true}) {
    TiffPage page = tiff_page(16, 16, SampleType::u16, samples);
    page.strip_rows = 4;
    page.deflate = deflate;
    write_tiff(directory / "whole.tif", {page});
    const auto whole = read_whole_file(directory / "whole.tif");
    for (std::size_t size = 0; size < whole.size(); size += 7) {
      write_whole_file(directory / "cut.tif", std::span(whole).first(size),
                       Durability::rename_only);
      try {
        ImageFile file(directory / "cut.tif");
        EXPECT_EQ(read_page<std::uint16_t>(file), samples) << "cut at " << size;
      } catch (const FormatError& error) {
        EXPECT_THAT(error.what(), HasSubstr("cut.tif"));
      }
    }
  }
}

// As when a copy of a file whose directory comes first was broken off.
TEST(ImageFile, FindsMissingSamplesBehindAGoodHeader) {
  const testing::TempDirectory directory;
  for (const bool deflate : {false, true}) {
    TiffPage page = tiff_page(64, 64, SampleType::u8, std::vector<std::uint8_t>(64 * 64, 9));
    page.strip_rows = 16;
    page.lost_tail = true;
    page.deflate = deflate;
    write_tiff(directory / "a.tif", {page});
    ImageFile file(directory / "a.tif");
    std::vector<std::byte> rows(64 * 64);
    file.read_rows({.y0 = 0, .y1 = 48}, rows);
    try {
      file.read_rows({.y0 = 40, .y1 = 64}, rows);
      ADD_FAILURE() << "read what is not there";
    } catch (const FormatError& error) {
      EXPECT_THAT(error.what(), AllOf(HasSubstr("a.tif: rows 40 to 63 of page 1"),
                                      HasSubstr("truncated or damaged")));
    }
  }
}

// A stack cut short must not pass for one of fewer slices.
TEST(ImageFile, FindsEveryMissingPage) {
  const testing::TempDirectory directory;
  for (const bool big : {false, true}) {
    const std::vector<TiffPage> pages(
        4, tiff_page(8, 8, SampleType::u8, std::vector<std::uint8_t>(64, 9)));
    write_tiff(directory / "whole.tif", pages, big);
    const auto whole = read_whole_file(directory / "whole.tif");
    for (std::size_t size = 0; size < whole.size(); ++size) {
      write_whole_file(directory / "cut.tif", std::span(whole).first(size),
                       Durability::rename_only);
      EXPECT_THROW(ImageFile(directory / "cut.tif"), FormatError) << "cut at " << size;
    }
    write_whole_file(directory / "cut.tif", std::span(whole).first(whole.size() - 1),
                     Durability::rename_only);
    EXPECT_THAT(failure_to_open(directory / "cut.tif"),
                AllOf(HasSubstr("directory of page 4"), HasSubstr("truncated")));
  }
}

TEST(ImageFile, RefusesPagesInALoop) {
  const testing::TempDirectory directory;
  const TiffPage page = tiff_page<std::uint8_t>(2, 1, SampleType::u8, {1, 2});
  write_tiff(directory / "a.tif", {page, page});
  auto bytes = read_whole_file(directory / "a.tif");
  std::copy_n(bytes.begin() + 4, 4, bytes.end() - 4);  // the last page's link: the first page
  write_whole_file(directory / "a.tif", bytes, Durability::rename_only);
  EXPECT_THAT(failure_to_open(directory / "a.tif"), HasSubstr("an earlier page again"));
}

TEST(WritePng, ReadsBackTheSame) {
  const testing::TempDirectory directory;
  for (const int channels : {1, 3, 4}) {
    std::vector<std::uint8_t> pixels(static_cast<std::size_t>(5 * 3 * channels));
    std::iota(pixels.begin(), pixels.end(), std::uint8_t{3});
    write_png(directory / "out/a.png", {5, 3, channels}, std::as_bytes(std::span(pixels)));
    ImageFile file(directory / "out/a.png");
    EXPECT_EQ(file.page(0).format, "png");
    EXPECT_EQ(file.page(0).channels, channels);
    EXPECT_EQ(read_page<std::uint8_t>(file), pixels);
  }
  const auto entries = std::filesystem::directory_iterator(directory / "out");
  EXPECT_EQ(std::distance(begin(entries), end(entries)), 1);  // no temporary left
}

TEST(WritePng, FindsEveryTruncation) {
  const testing::TempDirectory directory;
  std::vector<std::uint8_t> pixels(64 * 64);
  for (std::size_t i = 0; i < pixels.size(); ++i) pixels[i] = static_cast<std::uint8_t>(i * i / 7);
  write_png(directory / "a.png", {64, 64, 1}, std::as_bytes(std::span(pixels)));
  const auto whole = read_whole_file(directory / "a.png");
  for (std::size_t size = 0; size + 16 < whole.size(); size += 31) {
    write_whole_file(directory / "cut.png", std::span(whole).first(size), Durability::rename_only);
    try {
      ImageFile file(directory / "cut.png");
      EXPECT_EQ(read_page<std::uint8_t>(file), pixels) << "cut at " << size;
    } catch (const FormatError&) {
    }
  }
}

TEST(WritePng, RefusesSizesThatDoNotFit) {
  const testing::TempDirectory directory;
  const std::vector<std::byte> pixels(10);
  EXPECT_THROW(write_png(directory / "a.png", {2, 2, 3}, pixels), InputError);
  EXPECT_THROW(write_png(directory / "a.png", {0, 2, 3}, pixels), InputError);
  EXPECT_THROW(write_png(directory / "a.png", {5, 1, 2}, pixels), InputError);
  EXPECT_FALSE(std::filesystem::exists(directory / "a.png"));
}

}  // namespace
}  // namespace voxweld
