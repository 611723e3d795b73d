// What headers say that cannot be, or must not be believed: one policy for all readers.
#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "storage/volumes/axes.h"
#include "tests/storage/volumes/known_volume.h"

namespace voxweld::testing {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

const KnownVolume& small_volume() {
  static const KnownVolume volume = make_volume(SampleType::u8, {3, 4, 5});
  return volume;
}

// Files that say these spacings, each in its format's own way.
std::string nrrd_text(const std::string& spacings) {
  return "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 3 4 5\nencoding: raw\nspacings: " + spacings +
         "\n";
}
std::string metaimage_text(const std::string& spacings) {
  return "ObjectType = Image\nNDims = 3\nDimSize = 3 4 5\nElementType = MET_UCHAR\n"
         "ElementSpacing = " +
         spacings + "\n";
}
std::string inrimage_text(const std::array<std::string, 3>& spacings) {
  std::string head = fmt::format(
      "#INRIMAGE-4#{{\nXDIM=3\nYDIM=4\nZDIM=5\nVDIM=1\nTYPE=unsigned fixed\nPIXSIZE=8 bits\n"
      "SCALE=2**0\nCPU=decm\nVX={}\nVY={}\nVZ={}\n",
      spacings[0], spacings[1], spacings[2]);
  head.append(252 - head.size(), '\n');
  return head + "##}\n";
}

TEST(SoundHeaders, ASpacingThatCannotBeIsTheSameInAllReaders) {
  const VolumeFolder folder;
  const Bytes samples = small_volume().stored();
  const std::vector<std::pair<std::string, Bytes>> files = {
      {"a.nrrd", to_bytes(nrrd_text("-2 0 nan") + "\n") + samples},
      {"a.mha", to_bytes(metaimage_text("-2 0 nan") + "ElementDataFile = LOCAL\n") + samples},
      {"a.inr", to_bytes(inrimage_text({"-2", "0", "nan"})) + samples}};
  for (const auto& [name, bytes] : files) {
    const auto source = folder.open(name, bytes);
    const VolumeInfo& info = source->info();
    EXPECT_EQ(info.geometry.spacing, (Vec3{2, 1, 1})) << name;
    EXPECT_EQ(info.geometry.direction[0], (Vec3{1, 0, 0})) << name;
    EXPECT_THAT(info.warnings, ElementsAre(HasSubstr("a spacing of -2 is taken as 2"),
                                           HasSubstr("a spacing of 0 is taken as 1"),
                                           HasSubstr("a spacing of nan is taken as 1")))
        << name;
    for (const std::string& warning : info.warnings) EXPECT_THAT(warning, HasSubstr(name));
    expect_volume(*source, small_volume());
  }
}

TEST(SoundHeaders, AScalingThatCannotBeIsNone) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  VolumeInfo info;
  EXPECT_EQ(sound_scale(0, 5, "a", info), ValueScale{});
  EXPECT_EQ(sound_scale(1, 0, "a", info), ValueScale{});
  EXPECT_EQ(sound_scale(1, -1024, "a", info), (ValueScale{1, -1024}));
  EXPECT_EQ(sound_scale(2, 0, "a", info), (ValueScale{2, 0}));
  EXPECT_THAT(info.warnings, IsEmpty());
  EXPECT_EQ(sound_scale(nan, 0, "a", info), ValueScale{});
  EXPECT_EQ(sound_scale(1, std::numeric_limits<double>::infinity(), "a", info), ValueScale{});
  EXPECT_THAT(info.warnings,
              ElementsAre(HasSubstr("taken as stored"), HasSubstr("taken as stored")));
}

TEST(SoundHeaders, CoordinatesThatFloatsCannotHold) {
  VolumeGeometry geometry = geometry_of({100, 100, 100});
  const auto said = [&] {
    try {
      check_coordinates(geometry, "a.nrrd");
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_EQ(said(), "");
  for (const double spacing : {1e38, 1e35, 1e300}) {
    geometry.spacing.y = spacing;
    expect_says(said(), {"a.nrrd: the coordinates reach", "1e+36", "larger unit"});
  }
  geometry.spacing = {1, 1, 1e-40};
  expect_says(said(), {"1e-30", "smaller unit"});
  geometry.spacing = {1e33, 1e-29, 1};
  EXPECT_EQ(said(), "");
  geometry.origin.z = -1e37;
  expect_says(said(), {"coordinates reach 1e+37"});
  geometry.origin.z = std::numeric_limits<double>::infinity();
  expect_says(said(), {"coordinates reach"});
}

TEST(SoundHeaders, DataFilesElsewhereAreNotFollowedUnlessAsked) {
  const TempDirectory folder;
  fs::create_directory(folder / "headers");
  fs::create_directory(folder / "headers" / "below");
  const Bytes samples = small_volume().stored();
  const std::string absolute = (folder / "data.raw").string();
  for (const char* place : {"data.raw", "headers/data.raw", "headers/below/data.raw"})
    write_file(folder / place, samples);
  fs::create_symlink(absolute, folder / "headers" / "link.raw");
  const auto spec = [&](const std::string& header, const std::string& text) {
    return InputSpec{.path = write_file(folder / "headers" / header, text).string()};
  };
  const auto each_header = [&](const std::string& name, const auto& f) {
    f(spec("a.nhdr", nrrd_text("1 1 1") + "data file: " + name + "\n"));
    f(spec("a.mhd", metaimage_text("1 1 1") + "ElementDataFile = " + name + "\n"));
    std::string slices;
    for (int z = 0; z < 5; ++z) slices += name + "\n";
    f(spec("a.nhdr", nrrd_text("1 1 1") + "data file: LIST\n" + slices));
  };
  for (const std::string& name :
       {absolute, std::string("../data.raw"), std::string("below/../../data.raw"),
        (folder / "headers" / "data.raw").string()})
    each_header(name, [&](InputSpec header) {
      expect_says(complaint(header), {header.path, name, "input.follow = true"});
      header.follow = true;
      EXPECT_EQ(complaint(header), "");
    });
  for (const char* name : {"data.raw", "below/data.raw", "below/../data.raw", "link.raw"})
    each_header(name, [&](const InputSpec& header) { EXPECT_EQ(complaint(header), "") << name; });
}

// A claimed size is held against what the file can hold before anything is read.
TEST(SoundHeaders, SizesThatTheFileCannotHoldAreRefusedUnread) {
  const VolumeFolder folder;
  const Bytes stream = deflated(small_volume().stored(), Wrapper::gzip);
  const std::string sizes = "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 12000 12000 12000\n";
  for (const char* encoding : {"gzip", "ascii"}) {
    const Bytes file = to_bytes(sizes + "encoding: " + encoding + "\n\n") +
                       (encoding[0] == 'g' ? stream : to_bytes(as_text(small_volume())));
    std::string said;
    try {
      folder.open("a.nrrd", file);
    } catch (const FormatError& error) {
      said = error.what();
    }
    expect_says(said, {"a.nrrd: truncated: the header announces 1728000000000", "get a complete"});
  }
  // As much as there can be is let pass.
  const Bytes zeros(1'000'000);
  EXPECT_EQ(folder.complaint("a.nrrd",
                             to_bytes("NRRD0004\ntype: uint8\ndimension: 3\nsizes: 100 100 100\n"
                                      "encoding: gzip\n\n") +
                                 deflated(zeros, Wrapper::gzip)),
            "");
}

// So that slices larger than memory can be looked at.
TEST(SoundHeaders, AStreamGivesBandsOfRows) {
  const VolumeFolder folder;
  const KnownVolume volume = make_volume(SampleType::i16, {7, 9, 4});
  const auto source = folder.open(
      "a.nrrd", to_bytes("NRRD0004\ntype: int16\ndimension: 3\nsizes: 7 9 4\nendian: little\n"
                         "encoding: gzip\n\n") +
                    deflated(volume.stored(), Wrapper::gzip));
  for (int pass = 0; pass < 2; ++pass)
    for (std::int64_t z = 0; z < 4; z += 2)
      for (std::int64_t y = 1; y < 9; y += 3) {
        const Box3 box{{0, y, z}, {7, std::min<std::int64_t>(y + 2, 9), z + 1}};
        ASSERT_EQ(read_box(*source, box), volume.box(box));
      }
}

}  // namespace
}  // namespace voxweld::testing
