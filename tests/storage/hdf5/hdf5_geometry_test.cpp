// Spacings and places as NeXus, CREMI, Imaris and MINC write them.
#include <algorithm>
#include <fstream>

#include "tests/storage/hdf5/hdf5_files.h"

namespace voxweld::testing {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class Hdf5Geometry : public Hdf5Files {
 protected:
  // The file's own ending, which open_path does not know.
  std::unique_ptr<SampleSource> open(const std::string& name, const std::string& ending,
                                     const InputSelection& select = {}) const {
    InputSpec spec{.path = path(name, ending)};
    spec.select = select;
    return open_volume(spec);
  }
};

void expect_near(Vec3 found, Vec3 expected) {
  for (int a = 0; a < 3; ++a) EXPECT_NEAR(found[a], expected[a], 1e-9) << "axis " << a;
}

// World position of a sample.
Vec3 place_of(const VolumeGeometry& geometry, Index3 at) {
  Vec3 place = geometry.origin;
  for (int a = 0; a < 3; ++a)
    place = place + geometry.direction[static_cast<std::size_t>(a)] *
                        (geometry.spacing[a] * static_cast<double>(at[a]));
  return place;
}

TEST_F(Hdf5Geometry, NexusAxes) {
  make({"nexus"});
  const auto source = open_path(path("nexus"));  // of two datasets the one it calls its own
  expect_volume(*source, expected("nexus", SampleType::f32, {6, 5, 4}));
  const VolumeGeometry& geometry = source->info().geometry;
  EXPECT_EQ(geometry.spacing, (Vec3{0.125, 0.25, 0.5}));
  EXPECT_EQ(geometry.unit, "mm");
  expect_near(place_of(geometry, {0, 0, 0}), {0.0625, 7, 10});
  expect_near(place_of(geometry, {5, 4, 3}), {0.6875, 6, 11.5});
  EXPECT_THAT(source->info().warnings, IsEmpty());
}

TEST_F(Hdf5Geometry, NexusAxesThatAreNoGrid) {
  make({"nexus-uneven", "nexus-units", "tomo"});
  expect_says(said_of("nexus-uneven"), {"/entry/data/signal", "axis 'height'", "not equally far"});
  InputSpec spec{.path = path("nexus-uneven")};
  spec.spacing = Vec3{1, 2, 3};
  const auto source = open_volume(spec);
  EXPECT_EQ(source->info().geometry.spacing, *spec.spacing);
  EXPECT_THAT(source->info().warnings, Contains(HasSubstr("not equally far")));
  expect_says(said_of("nexus-units"), {"different units", "mm"});
  expect_says(said_of("tomo"), {"/entry/data/data", "projections and no volume"});
}

TEST_F(Hdf5Geometry, Cremi) {
  make({"cremi"});
  const auto source = open_path(path("cremi"));
  expect_volume(*source, expected("cremi", SampleType::u8, {6, 5, 4}));
  EXPECT_EQ(source->info().geometry.spacing, (Vec3{8, 4, 40}));
  EXPECT_EQ(source->info().geometry.origin, (Vec3{80, 40, 400}));
  EXPECT_EQ(source->info().geometry.unit, "nm");
}

TEST_F(Hdf5Geometry, Imaris) {
  make({"imaris"});
  expect_says(complaint(path("imaris", "ims")), {"holds 2 times", "--time"});
  expect_says(complaint(with_dataset(path("imaris", "ims"), "/DataSet")), {"an Imaris file"});
  InputSelection select;
  select.time = 1;
  select.channel = 2;
  const auto full = open("imaris", "ims", select);
  expect_volume(*full, expected("imaris-0", SampleType::u16, {6, 5, 4}));
  EXPECT_EQ(full->info().geometry.spacing, (Vec3{0.5, 4, 1}));
  EXPECT_EQ(full->info().geometry.unit, "um");
  expect_near(place_of(full->info().geometry, {0, 0, 0}), {10.25, 4, 4.5});
  expect_near(place_of(full->info().geometry, {5, 4, 3}), {12.75, 20, 1.5});
  select.level = 1;
  select.time = select.channel = 0;
  const auto coarse = open("imaris", "ims", select);
  expect_volume(*coarse, expected("imaris-1", SampleType::u16, {3, 3, 2}));
  EXPECT_EQ(coarse->info().geometry.spacing.x, 1);
  select.level = 2;
  EXPECT_THROW(open("imaris", "ims", select), InputError);
}

// nibabel reads places and real values.
TEST_F(Hdf5Geometry, Minc) {
  VOXWELD_NEEDS_PYTHON("h5py, nibabel");
  make({"minc"});
  const auto source = open("minc", "mnc");
  const KnownVolume volume = expected("minc", SampleType::i16, {5, 6, 4});
  expect_volume(*source, volume);
  const VolumeInfo& info = source->info();
  EXPECT_EQ(info.geometry.space, "RAS");
  EXPECT_EQ(info.geometry.unit, "mm");
  EXPECT_EQ(info.geometry.spacing, (Vec3{2, 1.5, 3}));
  double affine[3][4];
  std::ifstream text(path("minc", "affine"));
  for (auto& row : affine)
    for (double& number : row) text >> number;
  ASSERT_TRUE(text);
  for (const Index3 at : {Index3{0, 0, 0}, Index3{4, 5, 3}, Index3{1, 4, 2}}) {
    // In the file's order: z, x, y.
    const double index[] = {double(at.z), double(at.x), double(at.y), 1};
    Vec3 place;
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 4; ++c) place[r] += affine[r][c] * index[c];
    expect_near(place_of(info.geometry, at), place);
  }
  const Bytes real = read_whole_file(path("minc", "real"));
  const Bytes stored = read_whole_file(path("minc", "raw"));
  each_index(volume.size, [&](Index3 at) {
    double value = 0;
    std::int16_t sample = 0;
    const std::int64_t theirs = (at.z * 5 + at.x) * 6 + at.y, ours = (at.z * 6 + at.y) * 5 + at.x;
    std::memcpy(&value, real.data() + theirs * 8, 8);
    std::memcpy(&sample, stored.data() + ours * 2, 2);
    // It keeps to the valid range; we do not.
    EXPECT_NEAR(std::clamp(info.scale.real(sample), -6.0, 10.0), value, 1e-9);
  });
}

TEST_F(Hdf5Geometry, MincThatIsScaledBySlices) {
  make({"minc-slices", "minc-float"});
  expect_says(complaint(path("minc-slices", "mnc")),
              {"image-max", "from slice to slice (10 to 11)", "mincreshape -normalize"});
  const auto source = open("minc-float", "mnc");
  EXPECT_TRUE(source->info().scale.identity());
  EXPECT_EQ(source->info().type, SampleType::f32);
}

}  // namespace
}  // namespace voxweld::testing
