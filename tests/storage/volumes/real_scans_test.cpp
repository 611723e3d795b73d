// Files that other programs wrote. The figures were worked out from the files without this code:
// headers by eye and od, samples by decompressing and summing them with other tools.
#include <sstream>

#include "tests/storage/volumes/known_volume.h"
#include "tests/support/test_names.h"

namespace voxweld::testing {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

struct Expected {
  std::string file;
  Index3 size;
  SampleType type = SampleType::u8;
  Vec3 spacing;
  Access access = Access::box;
  std::int64_t lowest = 0, highest = 0, sum = 0;
};

// Reads slab by slab, as a stream has to be read.
template <class T>
void expect_values(const SampleSource& source, const Expected& expected) {
  const Index3 size = source.info().geometry.size;
  std::int64_t lowest = std::numeric_limits<std::int64_t>::max(), highest = -lowest, sum = 0;
  for (std::int64_t z = 0; z < size.z; z += 16) {
    const Bytes bytes = read_box(source, {{0, 0, z}, {size.x, size.y, std::min(z + 16, size.z)}});
    for (std::size_t i = 0; i < bytes.size(); i += sizeof(T)) {
      T value;
      std::memcpy(&value, bytes.data() + i, sizeof(T));
      lowest = std::min<std::int64_t>(lowest, value);
      highest = std::max<std::int64_t>(highest, value);
      sum += value;
    }
  }
  EXPECT_EQ(lowest, expected.lowest);
  EXPECT_EQ(highest, expected.highest);
  EXPECT_EQ(sum, expected.sum);
}

void PrintTo(const Expected& expected, std::ostream* out) {
  *out << expected.file;
}

class RealScan : public ::testing::TestWithParam<Expected> {};

TEST_P(RealScan, SizeTypeSpacingAndValues) {
  const Expected& expected = GetParam();
  VOXWELD_NEEDS_SHARED_DATA(expected.file);
  const auto source = open_path(shared_data(expected.file));
  const VolumeInfo& info = source->info();
  EXPECT_EQ(info.geometry.size, expected.size);
  EXPECT_EQ(info.type, expected.type);
  EXPECT_EQ(info.access, expected.access);
  for (int axis = 0; axis < 3; ++axis)
    EXPECT_NEAR(info.geometry.spacing[axis], expected.spacing[axis], 1e-6);
  if (expected.type == SampleType::u8) expect_values<std::uint8_t>(*source, expected);
  if (expected.type == SampleType::i16) expect_values<std::int16_t>(*source, expected);
  if (expected.type == SampleType::u16) expect_values<std::uint16_t>(*source, expected);
}

// File, size, type, spacing, access; the least sample, the greatest and the sum of all.
const char* const expectations = R"(
nifti/CT_pitch.nii.gz 175 248 58 uint8 0.8125 0.8125 2.39704943 stream 0 255 95678796
nifti/Iguana.nii.gz 210 256 179 uint8 0.1018 0.1018 0.1018 stream 0 229 317230873
nifti/bonsai.nii.gz 256 256 256 uint8 1 1 1 stream 0 255 225901147
nifti/chris_PD.nii.gz 191 256 54 uint8 0.85787511 0.85937494 2.39999723 stream 0 252 125243884
nifti/engine.nii.gz 256 256 128 uint8 1 1 1 stream 0 255 173590544
nifti/fuel.nii.gz 64 33 32 uint8 1 1 1 stream 0 255 509815
nrrd/tooth.nhdr 103 94 161 uint16 1 1 1 box 0 1300 821287590
nrrd/headsq/quarter.nhdr 64 64 93 int16 3.2 3.2 1.5 box 0 3926 193392317
nrrd/Brain.nrrd 160 232 160 uint8 1 0.898437 0.898437 stream 0 1 1822964
nrrd/Skull.nrrd 160 232 160 uint8 1 0.898437 0.898437 stream 0 1 532633
nrrd/BrainSkull.nrrd 160 232 160 uint8 1 0.898437 0.898437 stream 0 1 2429197
nrrd/pynrrd/BallBinary30x30x30.nrrd 30 30 30 int16 1 1 1 box 0 257 3682296
nrrd/pynrrd/BallBinary30x30x30.nhdr 30 30 30 int16 1 1 1 box 0 257 3682296
nrrd/pynrrd/BallBinary30x30x30_gz.nrrd 30 30 30 int16 1 1 1 stream 0 257 3682296
nrrd/pynrrd/BallBinary30x30x30_gz_lineskip.nrrd 30 30 30 int16 1 1 1 stream 0 257 3682296
nrrd/pynrrd/BallBinary30x30x30_gz_byteskip_minus_one.nrrd 30 30 30 int16 1 1 1 stream 0 257 3682296
nrrd/pynrrd/BallBinary30x30x30_byteskip_minus_one.nhdr 30 30 30 int16 1 1 1 box 0 257 3682296
nrrd/pynrrd/BallBinary30x30x30_byteskip_minus_one_nifti.nhdr 30 30 30 int16 1 1 1 stream 0 257 3682296
nrrd/pynrrd/BallBinary30x30x30.nii.gz 30 30 30 int16 1 1 1 stream 0 257 3682296
label/frogtissue.mhd 500 470 136 uint8 1 1 1.5 stream 0 29 12279472
label/liver.inr.gz 438 353 165 uint8 0.617188 0.617188 1.33333 stream 0 255 847320240
vtk/HeadMRVolume.mhd 48 62 42 uint8 4 4 4 box 0 255 3058332
)";

std::vector<Expected> read_expectations() {
  std::vector<Expected> all;
  std::istringstream in(expectations);
  std::string type, access;
  for (Expected e; in >> e.file >> e.size.x >> e.size.y >> e.size.z >> type >> e.spacing.x >>
                   e.spacing.y >> e.spacing.z >> access >> e.lowest >> e.highest >> e.sum;) {
    e.type = *std::ranges::find(all_types, type, sample_type_name);
    e.access = access == "stream" ? Access::stream : Access::box;
    all.push_back(e);
  }
  return all;
}

INSTANTIATE_TEST_SUITE_P(All, RealScan, ::testing::ValuesIn(read_expectations()),
                         [](const auto& scan) { return test_name(scan.param.file); });

// Every line of the table is a case.
TEST(RealScans, AreAllRead) {
  EXPECT_EQ(read_expectations().size(), 22U);
}

TEST(RealScans, GeometryOfTiltedAndPlacedVolumes) {
  VOXWELD_NEEDS_SHARED_DATA("nifti/CT_pitch.nii.gz");
  const VolumeGeometry ct = open_path(shared_data("nifti/CT_pitch.nii.gz"))->info().geometry;
  EXPECT_EQ(ct.unit, "mm");
  EXPECT_EQ(ct.space, "RAS");
  EXPECT_NEAR(ct.origin.y, -134.3856, 1e-4);
  EXPECT_NEAR(ct.direction[2].y * ct.spacing.z, 0.6808, 1e-4);
  EXPECT_NEAR(ct.direction[1].z * ct.spacing.y, -0.2308, 1e-4);

  const VolumeGeometry skull = open_path(shared_data("nrrd/Skull.nrrd"))->info().geometry;
  EXPECT_EQ(skull.space, "LPS");
  EXPECT_EQ(skull.origin, (Vec3{229.26, -126.419, 405.421}));
}

TEST(RealScans, OneSampleInFourDimensions) {
  VOXWELD_NEEDS_SHARED_DATA("nrrd/pynrrd/test_simple4d_raw.nrrd");
  const auto source = open_path(shared_data("nrrd/pynrrd/test_simple4d_raw.nrrd"));
  EXPECT_EQ(source->info().geometry.size, (Index3{1, 1, 1}));
  EXPECT_EQ(source->info().geometry.spacing, (Vec3{1.5, 1.5, 1}));
  EXPECT_EQ(source->info().type, SampleType::f64);
}

TEST(RealScans, AFloatInrimage) {
  VOXWELD_NEEDS_SHARED_DATA("label/skull_2.9.inr");
  const auto source = open_path(shared_data("label/skull_2.9.inr"));
  EXPECT_EQ(source->info().geometry.size, (Index3{64, 64, 64}));
  EXPECT_EQ(source->info().geometry.spacing, (Vec3{3.94305, 3.94305, 3.65079}));
  EXPECT_EQ(source->info().type, SampleType::f32);
  const Bytes sample = read_box(*source, {{29, 30, 31}, {30, 31, 32}});
  float value = 0;
  std::memcpy(&value, sample.data(), sizeof value);
  EXPECT_EQ(value, 3.371584892272949F);
}

TEST(RealScans, WhatCannotBeReadIsNamed) {
  VOXWELD_NEEDS_SHARED_DATA("nrrd/pynrrd/test1d_ascii.nrrd");
  const auto say = [](const char* name) { return complaint(shared_data(name)); };
  EXPECT_THAT(say("nrrd/pynrrd/BallBinary30x30x30_byteskip_minus_five.nhdr"), HasSubstr("'-5'"));
  EXPECT_THAT(say("nrrd/pynrrd/test1d_ascii.nrrd"), HasSubstr("1-D data are not a volume"));
  EXPECT_THAT(say("nrrd/pynrrd/test2d_ascii.nrrd"), HasSubstr("2-D data are not a volume"));
  EXPECT_THAT(say("vtk/neghip.slc"), AllOf(HasSubstr("unknown kind"), HasSubstr("supported")));
}

TEST(RealScans, WrongCompressedSizeAndShiftedSamplesWarn) {
  VOXWELD_NEEDS_SHARED_DATA("label/frogtissue.mhd");
  EXPECT_THAT(open_path(shared_data("label/frogtissue.mhd"))->info().warnings,
              ::testing::ElementsAre(AllOf(HasSubstr("CompressedDataSize"), HasSubstr("260020"),
                                           HasSubstr("262087"))));
  // Its samples lie behind a NIfTI header that the file forgets to skip.
  EXPECT_THAT(open_path(shared_data("nrrd/pynrrd/BallBinary30x30x30_nifti.nhdr"))->info().warnings,
              ::testing::ElementsAre(AllOf(HasSubstr("54352"), HasSubstr("54000"))));
}

}  // namespace
}  // namespace voxweld::testing
