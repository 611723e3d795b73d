// Which dataset of a file is read, and which of its dimensions are axes.
#include "tests/storage/hdf5/hdf5_files.h"

namespace voxweld::testing {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

class Hdf5Choice : public Hdf5Files {};

std::vector<std::string> chosen_of(const VolumeInfo& info) {
  std::vector<std::string> texts;
  for (const InputChoice& choice : info.choices)
    texts.push_back(choice.selector + " " + choice.value + (choice.chosen ? " *" : ""));
  return texts;
}

TEST_F(Hdf5Choice, OneOfSeveralDatasets) {
  make({"several"});
  expect_says(said_of("several"), {path("several"), "holds 2 datasets", "--dataset",
                                   "/a/large (6 x 7 x 8 float32)", "/a/small (3 x 4 x 5 uint16)"});
  for (const char* name : {"a/large", "/a/large", "/z"})
    expect_volume(*open_volume(with_dataset(path("several"), name)),
                  expected("several", SampleType::f32, {8, 7, 6}));
  InputSpec survey{.path = path("several")};
  survey.survey = true;
  const auto source = open_volume(survey);
  EXPECT_EQ(source->info().geometry.size, (Index3{8, 7, 6}));
  EXPECT_THAT(chosen_of(source->info()), ElementsAre("dataset /a/large *", "dataset /a/small"));
  EXPECT_THAT(source->info().warnings, Contains(HasSubstr("/a/large, the first of the largest")));
}

TEST_F(Hdf5Choice, WhatIsNoDatasetIsSaid) {
  make({"several", "empty"});
  expect_says(complaint(with_dataset(path("several"), "a")), {"'/a'", "is a group"});
  expect_says(complaint(with_dataset(path("several"), "b/c")), {"'/b/c'", "no such dataset"});
  expect_says(complaint(with_dataset(path("several"), "none")), {"'/none'", "no such dataset"});
  expect_says(said_of("empty"), {"no dataset of three dimensions of numbers"});
  expect_says(complaint(with_dataset(path("empty"), "zero")), {"its sizes are 0 x 4 x 5"});
  InputSpec level = with_dataset(path("several"), "a/large");
  level.select.level = 0;
  expect_says(complaint(level), {"only Imaris files have levels"});
}

TEST_F(Hdf5Choice, TwoDimensionsAreOneSlice) {
  make({"several"});
  const auto source = open_volume(with_dataset(path("several"), "flat"));
  EXPECT_EQ(source->info().geometry.size, (Index3{40, 30, 1}));
  EXPECT_THAT(source->info().warnings, Contains(HasSubstr("a volume of one slice")));
}

TEST_F(Hdf5Choice, NamedDimensionsGiveChannelAndTime) {
  make({"tzyxc"});
  InputSpec spec{.path = path("tzyxc")};
  expect_says(complaint(spec), {"exported_data", "holds 2 times (0, 1)", "--time"});
  spec.select.time = 1;
  expect_says(complaint(spec), {"holds 3 channels (0, 1, 2)", "--channel"});
  spec.select.channel = 3;
  expect_says(complaint(spec), {"--channel) is 3", "from 0 to 2"});
  spec.select.channel = 2;
  const auto source = open_volume(spec);
  expect_volume(*source, expected("tzyxc", SampleType::u8, {8, 7, 6}));
  EXPECT_EQ(source->info().geometry.spacing, (Vec3{0.5, 1.5, 2.5}));
  EXPECT_THAT(chosen_of(source->info()),
              ElementsAre("time 0", "time 1 *", "channel 0", "channel 1", "channel 2 *"));
  spec = {.path = path("tzyxc")};
  spec.survey = true;
  EXPECT_THAT(open_volume(spec)->info().warnings, Contains(HasSubstr("holds 3 channels; this is")));
}

TEST_F(Hdf5Choice, AxesInAnotherOrderAreTurned) {
  make({"labelled"});
  const auto source = open_path(path("labelled"));
  expect_volume(*source, expected("labelled", SampleType::i16, {5, 6, 7}));
  EXPECT_EQ(source->info().geometry.spacing, (Vec3{1, 2, 3}));
  EXPECT_EQ(source->info().geometry.unit, "um");
}

TEST_F(Hdf5Choice, FurtherDimensions) {
  make({"fourd", "extra"});
  expect_says(said_of("fourd"), {"4 dimensions (3 x 4 x 5 x 6)", "axistags", "DIMENSION_LABELS"});
  expect_reads("extra", SampleType::u8, {6, 5, 4});
  InputSpec spec{.path = path("extra")};
  spec.select.channel = 0;
  expect_says(complaint(spec), {"--channel) is set, but no dimension is named so"});
}

}  // namespace
}  // namespace voxweld::testing
