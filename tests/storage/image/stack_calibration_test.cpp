#include "storage/image/stack_calibration.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "storage/support/error.h"
#include "tests/support/error_text.h"

namespace voxweld {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

ImagePage described(const std::string& description, double resolution, const std::string& unit) {
  ImagePage page;
  page.description = description;
  page.x_resolution = page.y_resolution = resolution;
  page.resolution_unit = unit;
  return page;
}

std::string calibration_refusal(const std::string& description, std::size_t pages) {
  return testing::error_text<FormatError>([&] {
    read_calibration(described(description, 0, ""), {"a.tif", pages});
  });
}

TEST(Calibration, ReadsImageJ) {
  const auto result = read_calibration(
      described("ImageJ=1.53t\nimages=8\nslices=8\nunit=micron\nspacing=2.5\nloop=false\n", 4,
                "none"),
      {"a.tif", 8});
  ASSERT_TRUE(result.spacing);
  EXPECT_EQ(*result.spacing, (Vec3{0.25, 0.25, 2.5}));
  EXPECT_EQ(result.unit, "um");
  EXPECT_THAT(result.warnings, IsEmpty());
}

TEST(Calibration, DoesNotGuessTheDistanceOfSlices) {
  const auto imagej = read_calibration(
      described("ImageJ=1.53t\nimages=8\nslices=8\nunit=inch\nloop=false\n", 100, "in"),
      {"a.tif", 8});
  EXPECT_FALSE(imagej.spacing);
  EXPECT_THAT(imagej.warnings, ElementsAre(HasSubstr("0.254 x 0.254 mm")));
  const auto tags = read_calibration(described("", 1000, "cm"), {"a.tif", 8});
  EXPECT_FALSE(tags.spacing);
  EXPECT_THAT(tags.warnings, ElementsAre(HasSubstr("0.01 x 0.01 mm")));
  EXPECT_THAT(read_calibration(described("", 72, "in"), {"a.tif", 8}).warnings, IsEmpty());
}

TEST(Calibration, RefusesWhatIsNotOneVolume) {
  EXPECT_THAT(calibration_refusal("ImageJ=1\nimages=8\nchannels=2\nslices=4\n", 8),
              HasSubstr("2 channels"));
  EXPECT_THAT(calibration_refusal("ImageJ=1\nimages=8\nslices=4\nframes=2\n", 8),
              HasSubstr("2 times"));
  EXPECT_EQ(calibration_refusal("ImageJ=1\nimages=8\nframes=8\n", 8), "accepted");
  EXPECT_THAT(calibration_refusal("ImageJ=1\nimages=900\nslices=900\n", 1),
              HasSubstr("over 4 GiB"));
  EXPECT_THAT(
      calibration_refusal("<?xml?><OME><Pixels SizeC=\"3\" SizeZ=\"4\" SizeT=\"1\"></OME>", 12),
      HasSubstr("3 channels"));
}

TEST(Calibration, ReadsOme) {
  const auto result = read_calibration(
      described(
          "<OME><Image><Pixels ID=\"P\" SizeC=\"1\" SizeZ=\"4\" SizeT=\"1\" PhysicalSizeX=\"0.5\" "
          "PhysicalSizeY=\"0.5\" PhysicalSizeZ=\"2\"></Pixels></Image></OME>",
          0, ""),
      {"a.tif", 4});
  ASSERT_TRUE(result.spacing);
  EXPECT_EQ(*result.spacing, (Vec3{0.5, 0.5, 2}));
  EXPECT_EQ(result.unit, "um");
  const auto mixed = read_calibration(
      described("<OME><Pixels PhysicalSizeX=\"1\" PhysicalSizeXUnit=\"nm\" PhysicalSizeY=\"1\" "
                "PhysicalSizeZ=\"1\">",
                0, ""),
      {"a.tif", 4});
  EXPECT_FALSE(mixed.spacing);
  EXPECT_THAT(mixed.warnings, ElementsAre(HasSubstr("different units")));
}

}  // namespace
}  // namespace voxweld
