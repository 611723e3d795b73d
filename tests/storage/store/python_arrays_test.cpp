// Arrays of Zarr and N5 that zarr-python has written, compared with it sample by sample.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <nlohmann/json.hpp>
#include <random>

#include "storage/store/open_zarr.h"
#include "storage/support/file_io.h"
#include "tests/storage/store/memory_source.h"
#include "tests/support/temp_directory.h"

namespace voxweld {
namespace {

using Json = nlohmann::json;

// The folder with what the script has written, once for all tests; empty where zarr-python is
// missing.
const std::filesystem::path& written() {
  static const testing::TempDirectory folder;
  static const std::filesystem::path path = [] {
    const std::string script = VOXWELD_FOREIGN_ARRAYS;
    for (const char* python : {"python3", "/usr/bin/python3"})
      if (std::system((std::string(python) + " " + script + " " + folder.path().string() +
                       " > /dev/null 2>&1")
                          .c_str()) == 0)
        return folder.path();
    return std::filesystem::path();
  }();
  return path;
}

InputSpec spec_of(const Json& entry) {
  InputSpec spec{.path = entry.at("path")};
  const Json& select = entry.at("select");
  spec.select.dataset = select.value("dataset", "");
  if (select.contains("level")) spec.select.level = select.at("level");
  if (select.contains("channel")) spec.select.channel = select.at("channel");
  if (select.contains("time")) spec.select.time = select.at("time");
  return spec;
}

std::unique_ptr<SampleSource> open_case(const std::string& reader, const InputSpec& spec) {
  return (reader == "n5" ? n5_reader() : zarr_reader()).open(spec);
}

void expect_samples(const SampleSource& source, const Json& entry) {
  const auto samples = read_whole_file(entry.at("raw").get<std::string>());
  const auto size = entry.at("size").get<std::array<std::int64_t, 3>>();
  const Index3 extents{size[0], size[1], size[2]};
  ASSERT_EQ(source.info().geometry.size, extents);
  ASSERT_EQ(sample_type_name(source.info().type), entry.at("type").get<std::string>());
  testing::MemorySource expected(source.info().type, extents);
  ASSERT_EQ(expected.samples().size(), samples.size());
  expected.samples() = samples;
  EXPECT_TRUE(testing::read_box(source, expected.all()) == samples);
  std::mt19937 random(3);
  for (int i = 0; i < 12; ++i) {
    Box3 box;
    for (int axis = 0; axis < 3; ++axis) {
      box.lo[axis] = static_cast<std::int64_t>(random()) % extents[axis];
      box.hi[axis] =
          box.lo[axis] + 1 + static_cast<std::int64_t>(random()) % (extents[axis] - box.lo[axis]);
    }
    EXPECT_TRUE(testing::read_box(source, box) == testing::read_box(expected, box));
  }
}

TEST(PythonArrays, EverySampleIsAsItWasWritten) {
  if (written().empty()) GTEST_SKIP() << "python3 has no zarr: tests/install_packages.sh";
  const Json cases = Json::parse(read_text_file(written() / "cases.json"));
  EXPECT_GT(cases.size(), 80U);
  for (const Json& entry : cases) {
    SCOPED_TRACE(entry.at("name").get<std::string>());
    const auto source = open_case(entry.at("reader"), spec_of(entry));
    expect_samples(*source, entry);
  }
}

// Neither the detection nor a zip file's members are in doubt.
TEST(PythonArrays, TheReadersKnowTheirOwn) {
  if (written().empty()) GTEST_SKIP() << "python3 has no zarr: tests/install_packages.sh";
  for (const auto& [name, zarr, n5] : std::vector<std::tuple<const char*, Match, Match>>{
           {"v2-none.zarr", Match::contents, Match::none},
           {"stored.zarr.zip", Match::contents, Match::none},
           {"group.zip", Match::contents, Match::none},
           {"raw.n5", Match::none, Match::contents},
           {"raw.n5/a/b", Match::none, Match::contents},
           {"missing.raw", Match::none, Match::none}}) {
    InputProbe probe{.path = written() / name};
    probe.is_directory = std::filesystem::is_directory(probe.path);
    probe.is_file = !probe.is_directory;
    if (probe.is_file) probe.head = read_whole_file(probe.path);
    EXPECT_EQ(zarr_reader().test(probe), zarr) << name;
    EXPECT_EQ(n5_reader().test(probe), n5) << name;
  }
}

TEST(PythonArrays, ChoicesSpacingsAndWarnings) {
  if (written().empty()) GTEST_SKIP() << "python3 has no zarr: tests/install_packages.sh";
  InputSpec spec{.path = (written() / "ome.zarr").string(), .survey = true};
  const auto shown = open_case("zarr", spec);
  std::vector<std::string> choices;
  for (const InputChoice& choice : shown->info().choices)
    choices.push_back(choice.selector + " " + choice.value + (choice.chosen ? "* " : " ") +
                      choice.text);
  EXPECT_THAT(choices,
              ::testing::ElementsAre("dataset .* ", "dataset labels/cells ",
                                     "level 0* 0: 8 x 7 x 6 samples, 0.25 x 0.5 x 2 um",
                                     "level 1 1: 4 x 4 x 3 samples, 0.5 x 1 x 4 um", "time 0* ",
                                     "time 1 ", "time 2 ", "channel 0* DAPI", "channel 1 GFP"));
  EXPECT_EQ(shown->info().warnings.size(), 2U);  // a time and a channel were left open
  spec.select.level = 1;
  const auto coarse = open_case("zarr", spec);
  EXPECT_EQ(coarse->info().geometry.spacing, (Vec3{0.5, 1, 4}));
  EXPECT_EQ(coarse->info().geometry.origin, (Vec3{3, 0, 1}));
  EXPECT_EQ(coarse->info().geometry.unit, "um");
  InputSpec n5{.path = (written() / "pyramid.n5").string()};
  n5.select.level = 2;
  const auto level = open_case("n5", n5);
  EXPECT_EQ(level->info().geometry.spacing, (Vec3{8, 12, 16}));
  EXPECT_EQ(level->info().geometry.origin, (Vec3{3, 4.5, 6}));  // between the samples of level 0
  EXPECT_EQ(level->info().choices.size(), 3U);
}

}  // namespace
}  // namespace voxweld
