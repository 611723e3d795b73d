// Which grid of a file is read, and what is refused by name.
#include <openvdb/points/PointConversion.h>

#include "tests/storage/vdb/vdb_files.h"

namespace voxweld::testing {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;

class VdbChoice : public VdbFiles {};

openvdb::Vec3SGrid::Ptr wind() {
  auto grid = openvdb::Vec3SGrid::create();
  grid->setName("wind");
  grid->tree().setValue({1, 2, 3}, {1, 2, 3});
  return grid;
}

std::vector<std::string> choice_texts(const VolumeInfo& info) {
  std::vector<std::string> texts;
  for (const InputChoice& choice : info.choices)
    texts.push_back(choice.selector + " " + choice.value + ": " + choice.text +
                    (choice.chosen ? " *" : ""));
  return texts;
}

TEST_F(VdbChoice, OneOfSeveralGrids) {
  const auto density = strewn<openvdb::Int32Grid>("density", 1);
  const auto ball = level_set_ball();
  write("two", {ball, wind(), density});
  const std::string said = complaint(path("two"));
  expect_says(said, {path("two"), "the file has 3 grids",
                     "'density' (int32, unknown, active box (-20, -39, 100) to (29, 0, 129))",
                     "'surface' (float, level set, active box (", "'wind' (vec3s", "--dataset"});
  expect_volume(*open_volume(with_grid_name(path("two"), "density")),
                known_grid<std::int32_t>(*density));
  const auto source = open_volume(with_grid_name(path("two"), "surface"));
  expect_volume(*source, known_grid<float>(*ball));
  ASSERT_EQ(source->info().choices.size(), 3U);
  EXPECT_THAT(choice_texts(source->info())[1],
              ::testing::MatchesRegex("dataset surface: float, level set, active box .* \\*"));
  expect_says(complaint(with_grid_name(path("two"), "none")),
              {"no grid 'none'", "'density'", "'surface'", "input.dataset"});
}

TEST_F(VdbChoice, ASurveyShowsTheFirst) {
  write("two", {level_set_ball(), strewn<openvdb::Int32Grid>("density", 1)});
  InputSpec spec{.path = path("two")};
  spec.survey = true;
  const auto source = open_volume(spec);
  EXPECT_EQ(source->info().type, SampleType::i32);
  EXPECT_EQ(source->info().choices.size(), 2U);
  EXPECT_THAT(source->info().warnings, Contains(HasSubstr("the first of 2 grids")));
}

TEST_F(VdbChoice, TheOnlyScalarGridIsChosen) {
  const auto grid = strewn<openvdb::FloatGrid>("density", 1);
  write("one", {wind(), grid});
  expect_volume(*open_path(path("one")), known_grid<float>(*grid));
}

TEST_F(VdbChoice, GridsOfTheSameNameAreNumbered) {
  const auto first = strewn<openvdb::FloatGrid>("a", 1);
  const auto second = level_set_ball();
  second->setName("a");
  write("same", {first, second});
  expect_volume(*open_volume(with_grid_name(path("same"), "a[0]")), known_grid<float>(*first));
  expect_volume(*open_volume(with_grid_name(path("same"), "a[1]")), known_grid<float>(*second));
}

TEST_F(VdbChoice, GridsThatShareATree) {
  const auto first = strewn<openvdb::FloatGrid>("first", 1);
  const auto second = openvdb::gridPtrCast<openvdb::FloatGrid>(first->copyGrid());
  second->setName("second");
  write("shared", {first, second});
  expect_volume(*open_volume(with_grid_name(path("shared"), "second")), known_grid<float>(*first));
}

TEST_F(VdbChoice, VectorsAndPointsAreRefusedByName) {
  write("wind", {wind()});
  expect_says(complaint(path("wind")), {path("wind"), "grid 'wind' (vec3s", "vectors"});
  const std::vector<openvdb::Vec3R> places{{0, 0, 0}, {1, 2, 3}};
  const auto transform = openvdb::math::Transform::createLinearTransform(0.5);
  const openvdb::points::PointAttributeVector<openvdb::Vec3R> wrapped(places);
  const auto index =
      openvdb::tools::createPointIndexGrid<openvdb::tools::PointIndexGrid>(wrapped, *transform);
  const auto points = openvdb::points::createPointDataGrid<openvdb::points::NullCodec,
                                                           openvdb::points::PointDataGrid>(
      *index, wrapped, *transform);
  points->setName("dust");
  write("dust", {points});
  expect_says(complaint(path("dust")), {"grid 'dust' (ptdataidx32", "points"});
  expect_says(complaint(with_grid_name(path("wind"), "wind")), {"grid 'wind'"});
}

TEST_F(VdbChoice, WithoutAnythingInIt) {
  auto empty = openvdb::FloatGrid::create(1.0F);
  empty->setName("nothing");
  write("empty", {empty});
  expect_says(complaint(path("empty")), {path("empty"), "grid 'nothing'", "no active voxel"});
  write("both", {empty, strewn<openvdb::FloatGrid>("some", 1)});
  expect_says(complaint(path("both")), {"'nothing' (float, unknown, no active voxel)"});
  write("none", {});
  expect_says(complaint(path("none")), {path("none"), "no grid"});
}

TEST_F(VdbChoice, OtherSelectorsAreRefused) {
  write("ball", {level_set_ball()});
  InputSpec spec{.path = path("ball")};
  spec.select.level = 0;
  expect_says(complaint(spec), {"input.level", "vdb"});
}

}  // namespace
}  // namespace voxweld::testing
