// Lists of numbers on the command line: however they are written, wherever they are taken.
#include "tests/pipeline/cli/workplace.h"

namespace voxweld::testing {
namespace {

using Words = std::vector<std::string>;

TEST(NumberOptions, TakeListsHoweverTheyAreWritten) {
  const Workplace place;
  write_bytes(place.at("a.raw"), std::string(std::size_t{2} * 3 * 4, '\x7'));
  for (const Words& size : std::vector<Words>{
           {"2", "3", "4"}, {"2,3,4"}, {"2 3 4"}, {"[2, 3, 4]"}, {"2x3x4"}, {"2,", "3,", "4"}}) {
    const auto info = place.info(place.at("a.raw"), Words{"--type", "uint8", "--size"} + size +
                                                        Words{"--spacing", "0.5,0.5,2"});
    EXPECT_EQ(info.at("size"), (nlohmann::json{2, 3, 4})) << size.front();
    EXPECT_EQ(info.at("spacing"), (nlohmann::json{0.5, 0.5, 2.0})) << size.front();
  }
  // In front of the argument too.
  place.run({"info", "--type", "uint8", "--size", "2x3x4", place.at("a.raw")});
  place.run({"info", "--type", "uint8", "--size", "2", "3", "4", place.at("a.raw")});
}

TEST(NumberOptions, SayWhatTheyExpect) {
  const Words info = {"info", "a.raw", "--type", "uint8"};
  expect_refused(info + Words{"--size", "2,3"}, {"--size", "expected 3 whole numbers", "2,3"});
  expect_refused(info + Words{"--size", "2,3,4.5"}, {"expected 3 whole numbers"});
  expect_refused(info + Words{"--size", "2x3xx"}, {"expected 3 whole numbers"});
  expect_refused(info + Words{"--spacing", "1,2"}, {"--spacing", "expected 1 or 3 numbers", "1,2"});
}

TEST(NumberOptions, CentreAndKeysOfConfigsAndEditsToo) {
  const Workplace place;
  place.run({"init", place.phantom("scene.nrrd"), "-o", place.at("scene.toml")});
  const std::string config = place.at("scene.toml");
  Words trees;
  for (const char* crop : {"[4, 4, 4, 20, 20, 20]", "4,4,4,20,20,20", "4 4 4 20 20 20"}) {
    place.run({"run", config, "--set", std::string("input.crop=") + crop});
    trees.push_back(read_bytes(place.at("scene.mesh/mesh.drc")));
    EXPECT_EQ(trees.back(), trees.front()) << crop;
  }
  Words pictures;
  for (const Words& centre : std::vector<Words>{{"-1", "2", "3"}, {"-1,2,3"}, {"[-1, 2, 3]"}}) {
    place.run(Words{"render", place.at("scene.mesh"), "-o", place.at("a.png"), "--force", "--width",
                    "20", "--height", "20", "--centre"} +
              centre);
    pictures.push_back(read_bytes(place.at("a.png")));
    EXPECT_EQ(pictures.back(), pictures.front()) << centre.front();
  }
  for (const char* center : {"9,9,4", "9 9 4", "[9, 9, 4]"})
    place.run({"edit", config, "--add", "sphere", "--center", center, "--radius", "2", "--no-run"});
  const std::string list = place.run({"edit", config, "--list"}).out;
  for (const char* number : {"1", "2", "3"})
    EXPECT_THAT(list,
                ::testing::HasSubstr(std::string(number) + " add sphere center = [9.0, 9.0, 4.0]"));
}

}  // namespace
}  // namespace voxweld::testing
