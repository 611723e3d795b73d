// TIFF files of other writers (write_tiffs.py), sample by sample, and what must be said of those
// that are refused.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <map>
#include <random>
#include <sstream>

#include "tests/storage/volumes/known_volume.h"
#include "tests/support/error_text.h"

namespace voxweld::testing {
namespace {

using ::testing::HasSubstr;

std::string python_with_tifffile() {
  for (const char* python : {"python3", "/usr/bin/python3"})
    if (std::system((std::string(python) + " -c 'import numpy, tifffile' 2>/dev/null").c_str()) ==
        0)
      return python;
  return {};
}

std::vector<std::string> fields_of(const std::string& line) {
  std::vector<std::string> fields;
  std::istringstream text(line);
  for (std::string field; std::getline(text, field, '\t');) fields.push_back(field);
  return fields;
}

InputSpec spec_of(const std::filesystem::path& path, std::span<const std::string> keys) {
  InputSpec spec{.path = path.string()};
  for (const std::string& key : keys) {
    const std::string name = key.substr(0, key.find('=')), value = key.substr(name.size() + 1);
    if (name == "dataset") spec.select.dataset = value;
    if (name == "level") spec.select.level = std::stoll(value);
    if (name == "channel") spec.select.channel = std::stoll(value);
    if (name == "time") spec.select.time = std::stoll(value);
  }
  return spec;
}

KnownVolume expected_volume(const std::filesystem::path& raw, std::span<const std::string> facts) {
  KnownVolume volume{*parse_sample_type(facts[0]),
                     {std::stoll(facts[1]), std::stoll(facts[2]), std::stoll(facts[3])},
                     read_whole_file(raw)};
  if (std::endian::native != std::endian::little) volume.samples = volume.stored();
  return volume;
}

void expect_stack(const SampleSource& source, const KnownVolume& volume) {
  ASSERT_EQ(source.info().geometry.size, volume.size);
  ASSERT_EQ(source.info().type, volume.type);
  ASSERT_EQ(read_box(source, {{}, volume.size}), volume.samples);
  std::mt19937_64 random(3);
  for (int i = 0; i < 12; ++i) {
    Box3 box = random_box(volume.size, random);
    if (source.info().access == Access::slice) {
      box.lo.x = 0;
      box.hi.x = volume.size.x;
    }
    ASSERT_EQ(read_box(source, box), volume.box(box));
  }
}

void expect_spacing(const VolumeGeometry& geometry, const std::string& said) {
  std::istringstream text(said);
  Vec3 spacing;
  std::string unit;
  text >> spacing.x >> spacing.y >> spacing.z >> unit;
  for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(geometry.spacing[axis], spacing[axis], 1e-6);
  EXPECT_EQ(geometry.unit, unit);
}

void check_case(const std::filesystem::path& folder, const std::vector<std::string>& fields) {
  const std::span<const std::string> all(fields);
  if (fields[0] == "refused") {
    const InputSpec spec = spec_of(folder / fields[1], all.subspan(3));
    EXPECT_THAT(complaint(spec), HasSubstr(fields[2]));
    EXPECT_THAT(complaint(spec), HasSubstr(fields[1]));
    return;
  }
  const auto source = open_volume(spec_of(folder / fields[1], all.subspan(8)));
  expect_stack(*source, expected_volume(folder / fields[2], all.subspan(3, 4)));
  if (fields[7] != "-") expect_spacing(source->info().geometry, fields[7]);
}

// How many cases the script made, all of which were checked; -1 where it cannot run.
int check_script(const std::string& arguments) {
  const std::string python = python_with_tifffile();
  if (python.empty()) return -1;
  const TempDirectory folder;
  const std::string script = VOXWELD_TESTS "/storage/image/write_tiffs.py ";
  EXPECT_EQ(
      std::system((python + " -B " + script + folder.path().string() + " " + arguments).c_str()),
      0);
  std::ifstream list(folder / "cases.txt");
  int cases = 0;
  for (std::string line; std::getline(list, line); ++cases) {
    SCOPED_TRACE(line);
    try {
      check_case(folder.path(), fields_of(line));
    } catch (const std::exception& error) {
      ADD_FAILURE() << error.what();
    }
  }
  return cases;
}

TEST(ForeignTiffs, AreReadAsTheyWereWrittenOrRefused) {
  const int cases = check_script("");
  if (cases < 0) GTEST_SKIP() << "needs python3-tifffile";
  EXPECT_GT(cases, 200);  // without tiffcp
}

TEST(ForeignTiffs, OfTheCollectionAreReadAsByTifffile) {
  VOXWELD_NEEDS_SHARED_DATA("tiff");
  const int cases = check_script(shared_data("tiff").string());
  if (cases < 0) GTEST_SKIP() << "needs python3-tifffile";
  EXPECT_GT(cases, 50);
}

}  // namespace
}  // namespace voxweld::testing
