#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

#include "storage/support/file_io.h"
#include "tests/pipeline/cli/workplace.h"
#include "tests/support/deflated.h"

namespace voxweld::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

// NRRD of uint8 samples, compressed: it can only be read from front to back.
std::string gzip_nrrd(const std::string& samples, int side) {
  const std::string n = std::to_string(side);
  std::string text = "NRRD0004\ntype: uint8\ndimension: 3\nsizes: " + n + " " + n + " " + n +
                     "\nencoding: gzip\n\n";
  const auto packed = deflated(as_bytes(samples), Wrapper::gzip);
  return text + std::string(reinterpret_cast<const char*>(packed.data()), packed.size());
}

double isovalue_of(const Workplace& place, const std::string& config) {
  return place.info(config).at("settings").at("surface").at("isovalue").get<double>();
}

TEST(Init, LeadsToAMeshThatVerifies) {
  const Workplace place;
  const std::string input = place.phantom("scene.nrrd");
  const ProgramResult result = place.run({"init", input, "-o", place.at("scene.toml")});
  EXPECT_THAT(result.out, HasSubstr("surface.isovalue = "));
  EXPECT_THAT(result.out, HasSubstr("next: voxweld run " + place.at("scene.toml")));
  place.run({"run", place.at("scene.toml")});
  place.run({"verify", place.at("scene.mesh")});
}

TEST(Init, TakesTheIsovalueThatARunWithOtsuTakes) {
  const Workplace place;
  const std::string input = place.phantom("scene.nrrd");
  place.run({"init", input, "-o", place.at("scene.toml")});
  const ProgramResult run =
      place.run({"run", place.at("scene.toml"), "--set", "surface.isovalue=otsu"});
  const double chosen = isovalue_of(place, place.at("scene.toml"));
  std::string text = std::to_string(chosen);
  text.erase(text.find_last_not_of("0") + 1);
  EXPECT_THAT(run.err, HasSubstr("\"otsu\": " + text.substr(0, text.find_last_not_of(".") + 1)));
}

TEST(Init, ReadsCompressedVolumesFrontToBack) {
  const Workplace place;
  constexpr int side = 20;
  std::string samples;
  for (int i = 0; i < side * side * side; ++i)
    samples += static_cast<char>(i / (side * side) < 8 ? 10 : 90);
  write_bytes(place.at("scan.nrrd"), gzip_nrrd(samples, side));
  place.run({"init", place.at("scan.nrrd"), "-o", place.at("scan.toml")});
  EXPECT_EQ(isovalue_of(place, place.at("scan.toml")), 50);
  const nlohmann::json info = place.info(place.at("scan.nrrd"));
  EXPECT_EQ(info.at("access"), "stream");
  EXPECT_EQ(info.at("values").at("range"), nlohmann::json({10, 90}));
}

TEST(Init, NamesTheConfigAfterTheInputAndKeepsWhatIsThere) {
  const Workplace place;
  const std::string input = place.phantom("deep.scan.nrrd");
  const auto before = std::filesystem::current_path();
  std::filesystem::current_path(place.at(""));
  place.run({"init", input});
  std::filesystem::current_path(before);
  ASSERT_TRUE(std::filesystem::exists(place.at("deep.scan.toml")));
  const std::string config = place.at("deep.scan.toml");
  write_bytes(config, "mine");
  expect_refused({"init", input, "-o", config}, {config, "exists already", "--force"});
  EXPECT_EQ(read_bytes(config), "mine");
  place.run({"init", input, "-o", config, "--force"});
  EXPECT_THAT(read_bytes(config), HasSubstr("[surface]"));
}

TEST(Init, WritesPathsThatMoveWithTheConfig) {
  const Workplace place;
  std::filesystem::create_directories(place.at("scans"));
  std::filesystem::create_directories(place.at("configs"));
  const std::string input = place.phantom("scans/scene.nrrd");
  place.run({"init", input, "-o", place.at("above.toml")});
  EXPECT_THAT(read_bytes(place.at("above.toml")), HasSubstr("path = \"scans/scene.nrrd\"\n"));
  place.run({"init", input, "-o", place.at("configs/aside.toml")});
  EXPECT_THAT(read_bytes(place.at("configs/aside.toml")), HasSubstr("path = \"" + input + "\"\n"));
}

TEST(Init, PutsTheRawLayoutIntoTheConfig) {
  const Workplace place;
  std::string bytes = "head";
  for (int i = 0; i < 4 * 5 * 6; ++i) {
    bytes += static_cast<char>(i < 60 ? 1 : 3);  // big-endian: the high byte first
    bytes += static_cast<char>(0);
  }
  write_bytes(place.at("scan.dat"), bytes);
  place.run({"init",
             place.at("scan.dat"),
             "-o",
             place.at("scan.toml"),
             "--size",
             "4",
             "5",
             "6",
             "--type",
             "uint16",
             "--endian",
             "big",
             "--header-bytes",
             "4",
             "--spacing",
             "0.5",
             "0.5",
             "2",
             "--unit",
             "mm"});
  const nlohmann::json input = place.info(place.at("scan.toml")).at("settings").at("input");
  EXPECT_EQ(input.at("format"), "raw");
  EXPECT_EQ(input.at("size"), nlohmann::json({4, 5, 6}));
  EXPECT_EQ(input.at("type"), "uint16");
  EXPECT_EQ(input.at("endian"), "big");
  EXPECT_EQ(input.at("header_bytes"), 4);
  EXPECT_EQ(input.at("spacing"), nlohmann::json({0.5, 0.5, 2.0}));
  EXPECT_EQ(input.at("unit"), "mm");
  EXPECT_EQ(isovalue_of(place, place.at("scan.toml")), 512);
}

TEST(Init, WritesAShortConfigOrAFullOneThatMeansTheSame) {
  const Workplace place;
  const std::string input = place.phantom("scene.nrrd");
  const std::string config = place.at("scene.toml");
  place.run({"init", input, "-o", config, "--unit", "um"});
  const std::string brief = read_bytes(config);
  const nlohmann::json means = place.info(config).at("settings");
  EXPECT_EQ(means.at("input").at("unit"), "um");
  EXPECT_LT(std::ranges::count(brief, '\n'), 35);
  EXPECT_THAT(brief, HasSubstr("isovalue = "));
  EXPECT_THAT(brief, Not(HasSubstr("# chunk = ")));
  place.run({"init", input, "-o", config, "--unit", "um", "--full", "--force"});
  EXPECT_THAT(read_bytes(config), HasSubstr("\n# chunk = 32\n"));
  EXPECT_EQ(place.info(config).at("settings"), means);
}

TEST(Init, RefusesVolumesWithoutASurface) {
  const Workplace place;
  write_bytes(place.at("flat.raw"), std::string(64, '\7'));
  expect_refused({"init", place.at("flat.raw"), "-o", place.at("flat.toml"), "--size", "4", "4",
                  "4", "--type", "uint8"},
                 {"flat.raw", "all samples are 7", "4 x 4 x 4 uint8"});
  const float nan = std::numeric_limits<float>::quiet_NaN();
  std::string nans;
  for (int i = 0; i < 8; ++i) nans.append(reinterpret_cast<const char*>(&nan), sizeof nan);
  write_bytes(place.at("nan.raw"), nans);
  expect_refused({"init", place.at("nan.raw"), "-o", place.at("nan.toml"), "--size", "2", "2", "2",
                  "--type", "float32"},
                 {"nan.raw", "no sample is a number"});
  EXPECT_FALSE(std::filesystem::exists(place.at("flat.toml")));
}

TEST(Init, RefusesWhatItCannotRead) {
  const Workplace place;
  expect_refused({"init", place.at("nothing.nrrd")}, {"nothing.nrrd", "no such file"});
  write_bytes(place.at("scan.raw"), "abc");
  expect_refused({"init", place.at("scan.raw"), "--type", "uint8", "-o", place.at("a.toml")},
                 {"--type without --size"});
  expect_refused({"init", place.at("scan.raw"), "--type", "bits", "--size", "1", "1", "1"},
                 {"--type bits", "uint8"});
  expect_refused({"init", place.at("scan.raw"), "--type", "uint8", "--size", "2", "2", "2", "-o",
                  place.at("a.toml")},
                 {"scan.raw", "8", "3"});
}

}  // namespace
}  // namespace voxweld::testing
