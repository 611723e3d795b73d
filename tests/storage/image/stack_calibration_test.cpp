#include "storage/image/stack_calibration.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

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

OmeImage sized(std::array<std::string, 3> step, std::array<std::string, 3> unit) {
  OmeImage image;
  image.step = std::move(step);
  image.unit = std::move(unit);
  return image;
}

TEST(Calibration, ReadsOme) {
  const auto result =
      ome_calibration(sized({"0.5", "0.5", "2"}, {"um", "\xC2\xB5m", "um"}), "a.tif");
  ASSERT_TRUE(result.spacing);
  EXPECT_EQ(*result.spacing, (Vec3{0.5, 0.5, 2}));
  EXPECT_EQ(result.unit, "um");
  EXPECT_FALSE(ome_calibration(sized({"0.5", "0.5", ""}, {"um", "um", "um"}), "a.tif").spacing);
}

TEST(Calibration, BringsUnitsOfOmeTogether) {
  const auto metric = ome_calibration(sized({"250", "250", "1.5"}, {"nm", "nm", "um"}), "a.tif");
  ASSERT_TRUE(metric.spacing);
  EXPECT_EQ(metric.unit, "nm");
  EXPECT_DOUBLE_EQ(metric.spacing->x, 250);
  EXPECT_DOUBLE_EQ(metric.spacing->z, 1500);
  const auto mixed = ome_calibration(sized({"1", "1", "1"}, {"nm", "furlong", "nm"}), "a.tif");
  EXPECT_FALSE(mixed.spacing);
  EXPECT_THAT(mixed.warnings, ElementsAre(HasSubstr("do not go together")));
}

}  // namespace
}  // namespace voxweld
