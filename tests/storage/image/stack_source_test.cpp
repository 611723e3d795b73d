#include "storage/image/stack_source.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <fmt/format.h>
#include <fstream>

#include "storage/image/image_file.h"
#include "storage/support/error.h"
#include "storage/support/file_io.h"
#include "tests/storage/image/tiff_writer.h"
#include "tests/support/temp_directory.h"

namespace voxweld {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using testing::tiff_page;
using testing::TiffPage;
using testing::write_tiff;

std::uint16_t sample_at(std::int64_t x, std::int64_t y, std::int64_t z) {
  return static_cast<std::uint16_t>(x + 100 * y + 1000 * z);
}

TiffPage slice(std::uint32_t width, std::uint32_t height, std::int64_t z) {
  std::vector<std::uint16_t> samples;
  for (std::int64_t y = 0; y < height; ++y)
    for (std::int64_t x = 0; x < width; ++x) samples.push_back(sample_at(x, y, z));
  return tiff_page(width, height, SampleType::u16, samples);
}

void expect_samples(const SampleSource& source, const Box3& box) {
  std::vector<std::uint16_t> samples(static_cast<std::size_t>(box.count()));
  source.read(box, reinterpret_cast<std::byte*>(samples.data()));
  std::vector<std::uint16_t> expected;
  each_index(box, [&](Index3 at) { expected.push_back(sample_at(at.x, at.y, at.z)); });
  ASSERT_EQ(samples, expected);
}

std::string stack_refusal(const std::filesystem::path& path) {
  try {
    open_stack({path.string()});
  } catch (const Error& error) {
    EXPECT_EQ(error.exit_code(), 2);
    return error.what();
  }
  return "accepted";
}

class Stack : public ::testing::Test {
 protected:
  void write_slices(int count) {
    for (int z = 0; z < count; ++z)
      write_tiff(directory_ / fmt::format("slice{}.tif", z), {slice(6, 5, z)});
  }
  const testing::TempDirectory directory_;
};

TEST_F(Stack, OfADirectory) {
  write_slices(12);
  const auto source = open_stack({directory_.path().string()});
  const VolumeInfo& info = source->info();
  EXPECT_EQ(info.format, "stack");
  EXPECT_EQ(info.type, SampleType::u16);
  EXPECT_EQ(info.geometry.size, (Index3{6, 5, 12}));
  EXPECT_EQ(info.access, Access::slice);
  EXPECT_EQ(info.largest_decode, 6U * 5 * 2);
  ASSERT_EQ(info.files.size(), 12U);
  EXPECT_EQ(info.files[10].path, (directory_ / "slice10.tif").string());
  EXPECT_EQ(info.files[10].state.size, std::filesystem::file_size(directory_ / "slice10.tif"));
  EXPECT_NE(info.files[10].state.mtime_ns, 0);
  expect_samples(*source, {{0, 0, 0}, {6, 5, 12}});
  expect_samples(*source, {{0, 2, 9}, {6, 4, 11}});
}

TEST_F(Stack, OfAPattern) {
  write_slices(12);
  write_png(directory_ / "preview.png", {1, 1, 1}, std::vector<std::byte>(1));
  const auto source = open_stack(
      {.path = (directory_ / "slice?.tif").string(), .spacing = Vec3{1, 1, 2}, .unit = "mm"});
  EXPECT_EQ(source->info().geometry.size.z, 10);
  EXPECT_EQ(source->info().geometry.spacing, (Vec3{1, 1, 2}));
  EXPECT_EQ(source->info().geometry.unit, "mm");
  expect_samples(*source, {{0, 0, 0}, {6, 5, 10}});
}

TEST_F(Stack, OfOneMultiPageFile) {
  for (const bool big : {false, true}) {
    std::vector<TiffPage> pages;
    for (int z = 0; z < 9; ++z) pages.push_back(slice(4, 3, z));
    pages[0].description = "ImageJ=1.53t\nimages=9\nslices=9\nunit=mm\nspacing=0.5\n";
    pages[0].resolution = 10;
    write_tiff(directory_ / "a.tif", pages, big);
    const auto source = open_stack({(directory_ / "a.tif").string()});
    EXPECT_EQ(source->info().geometry.size, (Index3{4, 3, 9}));
    EXPECT_EQ(source->info().geometry.unit, "mm");
    EXPECT_DOUBLE_EQ(source->info().geometry.spacing.x, 0.1);
    EXPECT_DOUBLE_EQ(source->info().geometry.spacing.z, 0.5);
    EXPECT_EQ(source->info().files.size(), 1U);
    expect_samples(*source, {{0, 0, 0}, {4, 3, 9}});
    expect_samples(*source, {{0, 1, 7}, {4, 2, 9}});
  }
}

TEST_F(Stack, OfASingleImage) {
  write_tiff(directory_ / "a.tif", {slice(4, 3, 0)});
  const auto source = open_stack({(directory_ / "a.tif").string()});
  EXPECT_EQ(source->info().geometry.size, (Index3{4, 3, 1}));
  expect_samples(*source, {{0, 0, 0}, {4, 3, 1}});
}

TEST_F(Stack, OfGreyPngs) {
  for (int z = 0; z < 3; ++z) {
    const std::vector<std::byte> pixels(6, static_cast<std::byte>(z + 1));
    write_png(directory_ / fmt::format("{}.png", z), {3, 2, 1}, pixels);
  }
  const auto source = open_stack({directory_.path().string()});
  EXPECT_EQ(source->info().type, SampleType::u8);
  std::vector<std::byte> out(18);
  source->read({{0, 0, 0}, {3, 2, 3}}, out.data());
  EXPECT_EQ(out[17], std::byte{3});
}

TEST_F(Stack, ReadsMoreSlicesThanDescriptors) {
  write_slices(40);
  rlimit limit{};
  ASSERT_EQ(getrlimit(RLIMIT_NOFILE, &limit), 0);
  const rlimit saved = limit;
  // Loads the module first: it opens libraries.
  open_stack({(directory_ / "slice1.tif").string()});
  limit.rlim_cur = 24;
  ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &limit), 0);
  const auto source = open_stack({directory_.path().string()});
  expect_samples(*source, {{0, 0, 0}, {6, 5, 40}});
  ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &saved), 0);
}

TEST_F(Stack, RefusesUnlikeSlices) {
  write_slices(3);
  write_tiff(directory_ / "slice1.tif", {slice(6, 4, 1)});
  EXPECT_THAT(stack_refusal(directory_.path()),
              AllOf(HasSubstr("slice1.tif: 6 x 4 pixels"), HasSubstr("expected 6 x 5 pixels"),
                    HasSubstr("slice0.tif")));
  write_tiff(directory_ / "slice1.tif",
             {tiff_page(6, 5, SampleType::u8, std::vector<std::uint8_t>(30))});
  EXPECT_THAT(stack_refusal(directory_.path()), AllOf(HasSubstr("uint8"), HasSubstr("uint16")));
  write_tiff(directory_ / "slice1.tif", {slice(6, 5, 0), slice(6, 5, 1)});
  EXPECT_THAT(stack_refusal(directory_.path()),
              AllOf(HasSubstr("slice1.tif"), HasSubstr("2 pages")));
}

TEST_F(Stack, RefusesUnlikePages) {
  write_tiff(directory_ / "a.tif", {slice(6, 5, 0), slice(6, 5, 1), slice(3, 2, 2)});
  EXPECT_THAT(stack_refusal(directory_ / "a.tif"),
              AllOf(HasSubstr("a.tif, page 3: 3 x 2 pixels"), HasSubstr("expected 6 x 5")));
}

TEST_F(Stack, RefusesColour) {
  TiffPage page = tiff_page(2, 2, SampleType::u8, std::vector<std::uint8_t>(12));
  page.channels = 3;
  page.photometric = 2;
  write_tiff(directory_ / "a.tif", {page});
  EXPECT_THAT(stack_refusal(directory_ / "a.tif"),
              AllOf(HasSubstr("a.tif: has 3 channels: 0 (red), 1 (green), 2 (blue)"),
                    HasSubstr("set input.channel or --channel")));
}

TEST_F(Stack, NamesDamagedAndMissingSlices) {
  write_slices(4);
  std::ofstream(directory_ / "slice2.tif") << "garbage";
  EXPECT_THAT(stack_refusal(directory_.path()), HasSubstr("slice2.tif"));
  std::filesystem::remove(directory_ / "slice2.tif");
  EXPECT_THAT(stack_refusal(directory_.path()), AllOf(HasSubstr("missing"), HasSubstr("number 2")));
  EXPECT_THAT(stack_refusal(directory_ / "nowhere"), HasSubstr("no such file or directory"));
}

TEST_F(Stack, NoticesAFileThatChangesUnderWay) {
  write_slices(5);
  const auto source = open_stack({directory_.path().string()});
  write_tiff(directory_ / "slice3.tif", {slice(6, 5, 3), slice(6, 5, 4)});
  std::vector<std::byte> out(60);
  EXPECT_THROW(source->read({{0, 0, 3}, {6, 5, 4}}, out.data()), FormatError);
  source->read({{0, 0, 2}, {6, 5, 3}}, out.data());
}

TEST_F(Stack, WarnsOfWhatItIgnores) {
  TiffPage page = slice(4, 3, 0);
  page.orientation = 3;
  page.photometric = 0;
  write_tiff(directory_ / "a.tif", {page});
  const auto source = open_stack({(directory_ / "a.tif").string()});
  EXPECT_THAT(source->info().warnings,
              ::testing::UnorderedElementsAre(HasSubstr("orientation tag (3)"),
                                              HasSubstr("white as zero")));
}

}  // namespace
}  // namespace voxweld
