// Folders of slices: order, distances, duplicates, tilt, choice of series.
#include "tests/storage/dicom/dicom_folder.h"

namespace voxweld::testing {
namespace {

constexpr std::uint32_t position = 0x00200032, orientation = 0x00200037;
const InputSpec uniform{.path = {}, .resample = Resample::uniform};

InputSpec of_series(const std::string& series) {
  return {.path = {}, .select = {.series = series}};
}

Vec3 world(const VolumeGeometry& g, double i, double j, double k) {
  const Vec3 s = g.spacing;
  return g.origin + g.direction[0] * (s.x * i) + g.direction[1] * (s.y * j) +
         g.direction[2] * (s.z * k);
}

void expect_near(Vec3 actual, Vec3 expected) {
  for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(actual[axis], expected[axis], 1e-9) << axis;
}

TEST(DicomSlices, ByPositionWhateverTheirNames) {
  const DicomFolder folder;
  const auto source = folder.opened();
  expect_slices(*source, folder.volume);
  const VolumeInfo& info = source->info();
  EXPECT_EQ(info.geometry.spacing, (Vec3{0.5, 0.5, 2}));
  EXPECT_EQ(info.geometry.origin, (Vec3{-10, 20, 0}));
  EXPECT_EQ(info.geometry.direction, VolumeGeometry{}.direction);
  EXPECT_EQ(info.geometry.unit, "mm");
  EXPECT_EQ(info.geometry.space, "LPS");
  EXPECT_EQ(info.scale, (ValueScale{1, -1024}));
  EXPECT_EQ(info.files.size(), 6U);
  EXPECT_EQ(info.largest_decode, 0U);
  EXPECT_TRUE(info.choices.empty());
  EXPECT_EQ(warnings_of(*source), "");
}

TEST(DicomSlices, AlongTheNormalOfASagittalSeries) {
  DicomFolder folder;
  for (std::size_t z = 0; z < folder.slices.size(); ++z)
    folder.slices[z]
        .text(orientation, "DS", "0\\1\\0\\0\\0\\-1")
        .text(position, "DS", position_text(30 - 1.5 * static_cast<double>(z), 5, 6));
  const auto source = folder.opened();
  expect_slices(*source, folder.volume);
  const VolumeGeometry& g = source->info().geometry;
  EXPECT_EQ(g.direction[2], (Vec3{-1, 0, 0}));
  expect_near(world(g, 4, 3, 5), {30 - 7.5, 5 + 2, 6 - 1.5});
}

TEST(DicomSlices, OtherFilesArePassedOverAndNestedFoldersEntered) {
  const DicomFolder folder;
  folder.write();
  std::filesystem::create_directory(folder.path() / "deeper");
  std::filesystem::rename(folder.file(3), folder.path() / "deeper" / "x.y");
  write_file(folder.path() / "notes.txt", std::string("head of a patient"));
  write_file(folder.path() / "empty", std::string());
  const auto source = open_path(folder.path());
  expect_slices(*source, folder.volume);
  expect_says(warnings_of(*source),
              {"2 files that are no DICOM images are passed over (empty, ...)"});
}

TEST(DicomSlices, AGapIsToldAndFilledOnlyWhenAsked) {
  DicomFolder folder;
  folder.slices.erase(folder.slices.begin() + 3);
  expect_says(folder.said(), {"1 slice is missing", "2 mm and multiples", "the largest, 4 mm",
                              "--resample uniform"});
  const auto source = folder.opened(uniform);
  EXPECT_EQ(source->info().geometry.size.z, 6);
  EXPECT_EQ(source->info().geometry.spacing.z, 2);
  expect_says(warnings_of(*source), {"1 slice is missing", "5 slices are interpolated to 6 planes",
                                     "halves away from zero"});
  const Index3 n = folder.volume.size;
  const auto plane = [&](const Bytes& all, std::int64_t z, std::int64_t i) {
    std::int16_t value;
    std::memcpy(&value, all.data() + 2 * (z * n.x * n.y + i), 2);
    return value;
  };
  const Bytes read = read_box(*source, {{}, n});
  for (std::int64_t i = 0; i < n.x * n.y; ++i) {
    for (const std::int64_t z : {0, 1, 2, 4, 5})
      ASSERT_EQ(plane(read, z, i), plane(folder.volume.samples, z, i));
    const double mean =
        (plane(folder.volume.samples, 2, i) + plane(folder.volume.samples, 4, i)) / 2.0;
    ASSERT_EQ(plane(read, 3, i), static_cast<std::int16_t>(std::round(mean)));
  }
}

TEST(DicomSlices, UnevenOnesAreRefusedOrInterpolated) {
  DicomFolder folder({5, 4, 3});
  folder.slices[2].text(position, "DS", position_text(-10, 20, 5.123));
  expect_says(folder.said(), {"not equally far apart", "2 to 3.123 mm", "--resample uniform"});
  const auto source = folder.opened(uniform);
  EXPECT_EQ(source->info().geometry.size.z, 3);  // at 0, 2 and 4
  EXPECT_EQ(source->info().geometry.spacing.z, 2);
  const auto value = [&](const Bytes& b) {
    std::int16_t v;
    std::memcpy(&v, b.data(), 2);
    return v;
  };
  const Box3 top{{0, 0, 2}, {5, 4, 3}}, middle{{0, 0, 1}, {5, 4, 2}};
  const double a = value(folder.volume.box(middle)), b = value(folder.volume.box(top));
  EXPECT_EQ(value(read_box(*source, top)),
            static_cast<std::int16_t>(std::round(a + (b - a) * 2 / 3.123)));
}

TEST(DicomSlices, AlmostEvenOnesAreTakenAsEvenAndSaidSo) {
  DicomFolder folder;
  folder.slices[2].text(position, "DS", position_text(-10, 20, 4.015));
  const auto source = folder.opened();
  expect_slices(*source, folder.volume);
  expect_says(warnings_of(*source), {"2 mm apart on average", "up to 0.015 mm off"});
  folder.slices[2].text(position, "DS", position_text(-10, 20, 4.025));
  expect_says(folder.said(), {"not equally far apart"});
}

TEST(DicomSlices, PositionsRoundedToTenthsAreEven) {
  DicomFolder folder({5, 4, 8});
  for (std::size_t z = 0; z < 8; ++z)
    folder.slices[z].text(
        position, "DS",
        position_text(-10, 20.03, std::round(12.5 * static_cast<double>(z)) / 10 + 0.05));
  expect_slices(*folder.opened(), folder.volume);
}

TEST(DicomSlices, ATiltedGantryShearsTheThirdAxis) {
  DicomFolder folder;
  for (std::size_t z = 0; z < folder.slices.size(); ++z)
    folder.slices[z].text(
        position, "DS",
        position_text(-10, 20 + 0.5 * static_cast<double>(z), 2 * static_cast<double>(z)));
  const auto source = folder.opened();
  expect_slices(*source, folder.volume);
  expect_says(warnings_of(*source), {"14.04 degrees off their normal"});
  expect_near(world(source->info().geometry, 4, 3, 5), {-8, 20 + 2.5 + 1.5, 10});
}

TEST(DicomSlices, OneShiftedSidewaysIsRefused) {
  DicomFolder folder;
  folder.slices[2].text(position, "DS", position_text(-9, 20, 4));
  expect_says(folder.said(), {"lies 1 mm beside the line"});
  expect_says(folder.said(uniform), {"lies 1 mm beside the line"});
}

TEST(DicomSlices, EqualDuplicatesAreDroppedAndOthersRefused) {
  DicomFolder folder;
  folder.add(3, 6);
  const auto source = folder.opened();
  expect_slices(*source, folder.volume);
  expect_says(warnings_of(*source), {"1 slice is the same as another"});
  folder.add(4, 2);
  expect_says(folder.said(), {"2 different slices are at one position (-10, 20, 2)"});
  folder.slices.back().text(0x00200100, "IS", "2");
  expect_says(folder.said(), {"2 different slices", "echoes", ", time 2"});
}

TEST(DicomSlices, ScalesThatDifferAreRefused) {
  DicomFolder folder;
  folder.slices[4].text(0x00281053, "DS", "1.25");
  expect_says(folder.said(), {"1.25 * stored + -1024", "PET"});
}

TEST(DicomSlices, SeriesAreListedAndChosen) {
  DicomFolder folder({5, 4, 3});
  for (std::size_t z = 0; z < 3; ++z) {
    DicomFile other = folder.slices[z];
    other.text(0x0020000e, "UI", "1.2.9").text(0x00200011, "IS", "3");
    other.text(position, "DS", position_text(0, 0, 7 + 3 * static_cast<double>(z)));
    folder.slices.push_back(other);
  }
  expect_says(folder.said(), {"holds 2 volumes", "--series", "1: series 3, CT, 'a ball', 5 x 4 x 3",
                              "0.5 x 0.5 x 3 mm, UID 1.2.9", "2: series 7, CT", "UID 1.2.3"});
  for (const char* name : {"1", "1.2.9"}) {
    const auto source = folder.opened(of_series(name));
    EXPECT_EQ(source->info().geometry.origin.z, 7);
    ASSERT_EQ(source->info().choices.size(), 2U);
    EXPECT_TRUE(source->info().choices[0].chosen);
  }
  EXPECT_EQ(folder.opened(of_series("2"))->info().geometry.origin.z, 0);
  expect_says(folder.said(of_series("5")), {"has no series '5'", "UID 1.2.3"});
  const auto survey = folder.opened({.path = {}, .survey = true});
  expect_says(warnings_of(*survey), {"holds 2 volumes, of which this is number 1"});
}

TEST(DicomSlices, LocalizersAndColoursAreLeftAside) {
  DicomFolder folder({5, 4, 3});
  DicomFile scout = folder.slices[0], colour = folder.slices[0];
  scout.text(0x00080008, "CS", "ORIGINAL\\PRIMARY\\LOCALIZER");
  colour.text(0x00280004, "CS", "RGB").u16(0x00280002, 3);
  colour.u16(0x00280010, 1).u16(0x00280011, 2);
  folder.slices.insert(folder.slices.end(), {scout, colour});
  const auto source = folder.opened();
  expect_slices(*source, folder.volume);
  expect_says(warnings_of(*source), {"2 other groups of images, localizers"});
  EXPECT_EQ(source->info().choices.size(), 3U);
  folder.slices = {colour};
  expect_says(folder.said(), {"its pixels are colours (RGB"});
}

TEST(DicomSlices, MixedOrientationsSizesAndBitsAreSeveralVolumes) {
  DicomFolder folder({4, 4, 4});
  folder.slices[3].text(orientation, "DS", "0\\1\\0\\0\\0\\-1");
  expect_says(folder.said(), {"holds 2 volumes", "4 x 4 x 3", "4 x 4 x 1"});
  folder.slices[3] = folder.slices[2];
  folder.slices[3].u16(0x00280010, 2).text(position, "DS", position_text(-10, 20, 6));
  expect_says(folder.said(), {"holds 2 volumes", "4 x 2 x 1"});
  folder.slices[3] = folder.slices[2];
  folder.slices[3].u16(0x00280101, 12).u16(0x00280102, 11);
  expect_says(folder.said(), {"holds 2 volumes"});
}

TEST(DicomSlices, WithoutPositionsThereIsNoOrder) {
  DicomFolder folder;
  for (DicomFile& slice : folder.slices) slice.drop(position);
  expect_says(folder.said(), {"ImagePositionPatient", "its place among the 6 slices"});
}

TEST(DicomSlices, PaddingAndInvertedDisplayAreSaid) {
  DicomFolder folder;
  for (DicomFile& slice : folder.slices)
    slice.u16(0x00280120, 0xf830, "SS").text(0x00280004, "CS", "MONOCHROME1");
  const auto source = folder.opened();
  expect_slices(*source, folder.volume);
  expect_says(warnings_of(*source), {"samples of -3024 lie outside", "MONOCHROME1"});
}

TEST(DicomSlices, HighPaddingIsOutside) {
  DicomFolder folder;
  for (DicomFile& slice : folder.slices)
    slice.u16(0x00280120, 32767, "SS").u16(0x00280121, 20000, "SS");
  KnownVolume expected = folder.volume;
  int lowered = 0;
  for (std::size_t at = 0; at < expected.samples.size(); at += 2) {
    std::int16_t value;
    std::memcpy(&value, &expected.samples[at], 2);
    if (value < 20000) continue;
    value = -32768;
    std::memcpy(&expected.samples[at], &value, 2);
    ++lowered;
  }
  ASSERT_GT(lowered, 0);
  const auto source = folder.opened();
  expect_slices(*source, expected);
  expect_says(warnings_of(*source),
              {"samples of 18976 to 31743 lie outside", "they are read as -33792"});
}

}  // namespace
}  // namespace voxweld::testing
