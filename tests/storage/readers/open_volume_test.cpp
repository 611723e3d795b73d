#include "storage/readers/open_volume.h"

#include "tests/storage/volumes/known_volume.h"

namespace voxweld::testing {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

std::string nrrd_of(const KnownVolume& volume) {
  return "NRRD0001\ntype: uint8\ndimension: 3\nencoding: raw\nsizes: " +
         std::to_string(volume.size.x) + " " + std::to_string(volume.size.y) + " " +
         std::to_string(volume.size.z) + "\n\n";
}

TEST(OpenVolume, ContentsGoBeforeTheName) {
  const TempDirectory directory;
  const KnownVolume volume = make_volume(SampleType::u8, {3, 4, 5});
  for (const char* name : {"a.mhd", "a.nii", "a.raw", "a", "a.tif"}) {
    const auto path = write_file(directory / name, to_bytes(nrrd_of(volume)) + volume.stored());
    const auto source = open_path(path);
    EXPECT_EQ(source->info().format, "nrrd");
    expect_volume(*source, volume);
  }
}

TEST(OpenVolume, UnknownKindsListTheSupportedOnes) {
  const TempDirectory directory;
  const auto path = write_file(directory / "a.xyz", std::string("some text"));
  EXPECT_THAT(complaint(path),
              AllOf(HasSubstr("a.xyz: a file of an unknown kind"),
                    HasSubstr("supported are nrrd, metaimage, nifti, inrimage, "
                              "vti, vtk, mrc, amira, raw, zarr, n5, dicom, hdf5, vdb, stack. ")));
  EXPECT_THAT(complaint(directory.path()), HasSubstr("no images in this directory"));
  EXPECT_THAT(complaint(directory / "none.nrrd"), HasSubstr("none.nrrd: no such file"));
  EXPECT_THAT(complaint(InputSpec{.path = ""}), HasSubstr("no path"));
  EXPECT_THAT(complaint(InputSpec{.path = path.string(), .format = "bmp"}),
              AllOf(HasSubstr("unknown input format 'bmp'"), HasSubstr("nrrd")));
  for (const char* format :
       {"nrrd", "metaimage", "nifti", "inrimage", "vti", "vtk", "mrc", "amira"}) {
    EXPECT_THAT(complaint(InputSpec{.path = path.string(), .format = format}), HasSubstr("a.xyz"));
    EXPECT_THAT(complaint(InputSpec{.path = (directory / "none").string(), .format = format}),
                HasSubstr("none: no such file"));
  }
}

TEST(OpenVolume, NamesDecideWhereContentsSayNothing) {
  const TempDirectory directory;
  EXPECT_THAT(complaint(write_file(directory / "a.nrrd", std::string(""))),
              HasSubstr("not a NRRD file"));
  EXPECT_THAT(complaint(write_file(directory / "a.mhd", std::string(""))),
              HasSubstr("ElementDataFile"));
  EXPECT_THAT(complaint(write_file(directory / "a.nii.gz", std::string("x"))),
              HasSubstr("not a NIfTI header"));
  // A stated layout makes any file raw.
  const KnownVolume volume = make_volume(SampleType::u8, {3, 4, 5});
  InputSpec spec{.path = write_file(directory / "a.dat", volume.stored()).string()};
  spec.raw.size = volume.size;
  spec.raw.type = volume.type;
  expect_volume(*open_volume(spec), volume);
}

TEST(OpenVolume, EveryFormatHasItsRow) {
  const TempDirectory directory;
  for (const char* name : {"a.nrrd", "a.mha", "a.nii.gz", "a.inr", "a.vti", "a.vtk", "a.mrc",
                           "a.am", "a.raw", "a.zarr", "a.png"}) {
    if (std::string(name).ends_with(".zarr"))
      std::filesystem::create_directory(directory / name);
    else
      write_file(directory / name, std::string("x"));
  }
  const auto known_by = [&](const std::string& name) {
    const InputProbe probe = probe_input((directory / name).string());
    for (const VolumeReader& reader : volume_readers())
      if (reader.test(probe) != Match::none) return reader.name;
    return std::string();
  };
  EXPECT_EQ(known_by("a.nrrd"), "nrrd");
  EXPECT_EQ(known_by("a.mha"), "metaimage");
  EXPECT_EQ(known_by("a.nii.gz"), "nifti");
  EXPECT_EQ(known_by("a.inr"), "inrimage");
  EXPECT_EQ(known_by("a.vti"), "vti");
  EXPECT_EQ(known_by("a.vtk"), "vtk");
  EXPECT_EQ(known_by("a.mrc"), "mrc");
  EXPECT_EQ(known_by("a.am"), "amira");
  EXPECT_EQ(known_by("a.raw"), "raw");
  EXPECT_EQ(known_by("a.zarr"), "zarr");
  EXPECT_EQ(known_by("a.png"), "stack");
  EXPECT_EQ(known_by("."), "stack");
  EXPECT_EQ(known_by("b*.tif"), "stack");
  EXPECT_EQ(known_by("b.txt"), "");
  for (const VolumeReader& reader : volume_readers())
    EXPECT_NE(reader.open == nullptr, reader.module.empty()) << reader.name;
}

TEST(OpenVolume, OverridesAndCropApply) {
  const TempDirectory directory;
  const KnownVolume volume = make_volume(SampleType::u8, {3, 4, 5});
  const auto path = write_file(directory / "a.nrrd", to_bytes(nrrd_of(volume)) + volume.stored());
  InputSpec spec{.path = path.string()};
  spec.crop = Box3{{1, 0, 2}, {3, 4, 4}};
  spec.spacing = Vec3{2, 3, 4};
  spec.unit = "micron";
  const auto source = open_volume(spec);
  const VolumeGeometry& geometry = source->info().geometry;
  EXPECT_EQ(geometry.size, (Index3{2, 4, 2}));
  EXPECT_EQ(geometry.spacing, (Vec3{2, 3, 4}));
  EXPECT_EQ(geometry.origin, Vec3{});
  EXPECT_EQ(geometry.first, (Vec3{2, 0, 8}));  // in the overridden spacing
  EXPECT_EQ(geometry.unit, "um");
  EXPECT_EQ(read_box(*source, {{}, {2, 4, 2}}), volume.box(*spec.crop));
  spec.crop = Box3{{1, 0, 2}, {4, 4, 4}};
  EXPECT_THAT(complaint(spec),
              AllOf(HasSubstr("crop"), HasSubstr("(4, 4, 4)"), HasSubstr("3 x 4 x 5")));
  spec.crop = Box3{{1, 0, 2}, {1, 4, 4}};
  EXPECT_THAT(complaint(spec), HasSubstr("not empty"));
  spec.crop.reset();
  spec.spacing = Vec3{1, 0, 1};
  EXPECT_THAT(complaint(spec), HasSubstr("three positive numbers"));
}

}  // namespace
}  // namespace voxweld::testing
