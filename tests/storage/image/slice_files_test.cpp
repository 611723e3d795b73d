#include "storage/image/slice_files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "storage/image/slice_numbers.h"
#include "storage/support/error.h"
#include "tests/support/error_text.h"
#include "tests/support/temp_directory.h"

namespace voxweld {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

std::vector<std::string> names(const SliceFiles& files) {
  std::vector<std::string> result;
  for (const auto& path : files.paths) result.push_back(path.filename().string());
  return result;
}

std::string order_refusal(std::vector<std::filesystem::path> paths) {
  return testing::error_text<InputError>([&] { order_slices(std::move(paths)); });
}

TEST(SliceOrder, CountsInNumbersNotInCharacters) {
  const SliceFiles files = order_slices({"d/slice10.tif", "d/slice9.tif", "d/slice11.tif"});
  EXPECT_THAT(names(files), ElementsAre("slice9.tif", "slice10.tif", "slice11.tif"));
  EXPECT_THAT(files.warnings, IsEmpty());
}

TEST(SliceOrder, NamesMissingSlices) {
  EXPECT_THAT(
      order_refusal({"d/s001.tif", "d/s002.tif", "d/s004.tif", "d/s005.tif", "d/s009.tif"}),
      AllOf(HasSubstr("missing"), HasSubstr("number 3, 6 to 8;"), HasSubstr("found 5 files")));
  EXPECT_THAT(order_refusal({"d/s1.tif", "d/s3.tif"}), HasSubstr("number 2;"));
}

TEST(SliceOrder, TakesEveryNthSliceWithAWarning) {
  const SliceFiles files =
      order_slices({"d/s0.tif", "d/s10.tif", "d/s20.tif", "d/s5.tif", "d/s15.tif"});
  EXPECT_THAT(names(files), ElementsAre("s0.tif", "s5.tif", "s10.tif", "s15.tif", "s20.tif"));
  EXPECT_THAT(files.warnings, ElementsAre(HasSubstr("go up by 5")));
  EXPECT_THAT(order_refusal({"d/s0.tif", "d/s2.tif", "d/s4.tif", "d/s6.tif", "d/s10.tif"}),
              HasSubstr("number 8;"));
}

TEST(SliceOrder, RefusesANumberTwice) {
  EXPECT_THAT(order_refusal({"d/s1.tif", "d/s01.tif", "d/s2.tif"}),
              AllOf(HasSubstr("number 1 occurs twice"), HasSubstr("s01.tif"), HasSubstr("s1.tif")));
  EXPECT_THAT(order_refusal({"d/s1.tif", "d/s01.tif"}), HasSubstr("occurs twice"));
}

TEST(SliceOrder, RefusesStrangersAmongSlices) {
  EXPECT_THAT(order_refusal({"d/s1.tif", "d/s2.tif", "d/mask.tif"}),
              AllOf(HasSubstr("2 images are named like s1.tif"), HasSubstr("(mask.tif)")));
}

TEST(SliceOrder, FindsTheCounterAmongSeveralNumbers) {
  const SliceFiles files =
      order_slices({"d/930_scan_2.tif", "d/935_scan_1.tif", "d/931_scan_3.tif"});
  EXPECT_THAT(names(files), ElementsAre("935_scan_1.tif", "930_scan_2.tif", "931_scan_3.tif"));
  EXPECT_THAT(order_refusal({"d/z1_c1.tif", "d/z1_c2.tif", "d/z2_c1.tif", "d/z2_c2.tif"}),
              AllOf(HasSubstr("2 numbers vary"), HasSubstr("pattern")));
  EXPECT_THAT(order_slices({"d/10_5.tif", "d/12_8.tif"}).warnings,
              ElementsAre(HasSubstr("cannot be noticed")));
}

TEST(SliceOrder, WarnsWhenNamesHaveNoNumbers) {
  const SliceFiles files = order_slices({"d/b.tif", "d/a.tif"});
  EXPECT_THAT(names(files), ElementsAre("a.tif", "b.tif"));
  EXPECT_THAT(files.warnings, ElementsAre(HasSubstr("no numbering")));
}

TEST(NaturalLess, IsATotalOrder) {
  EXPECT_TRUE(natural_less("a2", "a10"));
  EXPECT_FALSE(natural_less("a10", "a2"));
  EXPECT_TRUE(natural_less("a", "a1"));
  EXPECT_TRUE(natural_less("a1", "a1b"));
  EXPECT_NE(natural_less("a01", "a1"), natural_less("a1", "a01"));
  EXPECT_FALSE(natural_less("a1", "a1"));
  EXPECT_TRUE(natural_less("a99999999999999999999998", "a99999999999999999999999"));
}

TEST(SplitNumbers, LeavesWhatNoIntegerHoldsAsText) {
  EXPECT_EQ(split_numbers("ab12c003").form, "ab#c#");
  EXPECT_THAT(split_numbers("ab12c003").numbers, ElementsAre(12, 3));
  EXPECT_EQ(split_numbers("x1234567890123456789").form, "x1234567890123456789");
}

class SliceListing : public ::testing::Test {
 protected:
  void touch(const std::string& name) { std::ofstream(directory_ / name) << name; }
  std::string refusal_of(const std::string& path) {
    return testing::error_text<InputError>([&] { find_slices(path); });
  }
  const testing::TempDirectory directory_;
};

TEST_F(SliceListing, TakesTheImagesOfADirectory) {
  touch("s1.TIF"), touch("s2.tiff"), touch("notes.txt"), touch(".hidden.tif");
  std::filesystem::create_directory(directory_ / "more.tif");
  const SliceFiles files = find_slices(directory_.path().string());
  EXPECT_THAT(names(files), ::testing::UnorderedElementsAre("s1.TIF", "s2.tiff"));
  EXPECT_THAT(files.warnings, ElementsAre(HasSubstr("notes.txt")));
}

TEST_F(SliceListing, RefusesMixedKindsByName) {
  touch("s1.tif"), touch("s2.tif"), touch("preview.png");
  EXPECT_THAT(
      refusal_of(directory_.path().string()),
      AllOf(HasSubstr("1 png (preview.png)"), HasSubstr("2 tif (s1.tif)"), HasSubstr("pattern")));
}

TEST_F(SliceListing, RefusesWhatIsNotThere) {
  EXPECT_THAT(refusal_of(directory_.path().string()), HasSubstr("no images"));
  EXPECT_THAT(refusal_of((directory_ / "none").string()), HasSubstr("no such file or directory"));
  EXPECT_THAT(refusal_of((directory_ / "*.tif").string()), HasSubstr("no file matches"));
}

TEST_F(SliceListing, PrefersAFileOfThatNameToAPattern) {
  touch("scan[1].tif"), touch("scan1.tif");
  EXPECT_THAT(names(find_slices((directory_ / "scan[1].tif").string())),
              ElementsAre("scan[1].tif"));
  EXPECT_THAT(names(find_slices((directory_ / "scan?.tif").string())), ElementsAre("scan1.tif"));
}

}  // namespace
}  // namespace voxweld
