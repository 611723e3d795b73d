#include "pipeline/phantom/write.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <map>
#include <sstream>

#include "storage/support/error.h"
#include "storage/support/file_io.h"
#include "tests/support/error_text.h"
#include "tests/support/temp_directory.h"

namespace voxweld {
namespace {

using ::testing::HasSubstr;

std::vector<std::byte> samples_of(const PhantomVolume& volume) {
  const PhantomSource source(volume);
  std::vector<std::byte> data(static_cast<std::size_t>(volume.size * volume.size * volume.size) *
                              sample_bytes(volume.type));
  source.read({{0, 0, 0}, splat(volume.size)}, data.data());
  return data;
}

struct Header {
  std::string magic;
  std::map<std::string, std::string> fields;
  std::size_t bytes = 0;  // up to and with the empty line
};

Header parse_header(const std::vector<std::byte>& file) {
  const std::string text(reinterpret_cast<const char*>(file.data()), file.size());
  Header header;
  header.bytes = text.find("\n\n") + 2;
  std::istringstream lines(text.substr(0, header.bytes));
  std::getline(lines, header.magic);
  for (std::string line; std::getline(lines, line) && !line.empty();) {
    if (line.front() == '#') continue;
    const std::size_t colon = line.find(": ");
    header.fields[line.substr(0, colon)] = line.substr(colon + 2);
  }
  return header;
}

TEST(WritePhantom, NrrdHoldsHeaderAndSamples) {
  const testing::TempDirectory directory;
  for (const SampleType type : {SampleType::u8, SampleType::u16, SampleType::f32}) {
    const PhantomSpec spec{directory / "a.nrrd",
                           {.kind = PhantomKind::part,
                            .size = 37,
                            .type = type,
                            .spacing = {0.5, 0.25, 2},
                            .unit = "mm"}};
    write_phantom(spec);
    const auto file = read_whole_file(spec.path);
    const Header header = parse_header(file);
    EXPECT_EQ(header.magic, "NRRD0005");
    const std::string name = type == SampleType::f32  ? "float"
                             : type == SampleType::u8 ? "uint8"
                                                      : "uint16";
    const std::map<std::string, std::string> expected = {
        {"type", name},
        {"dimension", "3"},
        {"space dimension", "3"},
        {"sizes", "37 37 37"},
        {"space directions", "(0.5,0,0) (0,0.25,0) (0,0,2)"},
        {"space origin", "(0,0,0)"},
        {"space units", "\"mm\" \"mm\" \"mm\""},
        {"kinds", "domain domain domain"},
        {"endian", "little"},
        {"encoding", "raw"}};
    EXPECT_EQ(header.fields, expected);
    const std::vector<std::byte> samples(file.begin() + static_cast<std::ptrdiff_t>(header.bytes),
                                         file.end());
    EXPECT_EQ(samples, samples_of(spec.volume));
  }
}

TEST(WritePhantom, DetachedHeaderNamesItsSamples) {
  for (const std::string name : {"b.nhdr", "b.raw"}) {
    const testing::TempDirectory directory;
    const PhantomSpec spec{directory / name, {.kind = PhantomKind::labels, .size = 20}};
    write_phantom(spec);
    EXPECT_EQ(read_whole_file(directory / "b.raw"), samples_of(spec.volume));
    const Header header = parse_header(read_whole_file(directory / "b.nhdr"));
    EXPECT_EQ(header.fields.at("data file"), "b.raw");
    EXPECT_EQ(header.fields.count("space units"), 0u);
  }
}

TEST(WritePhantom, SameBytesWhateverTheThreads) {
  const testing::TempDirectory directory;
  for (const PhantomKindInfo& info : phantom_kinds()) {
    std::vector<std::vector<std::byte>> files;
    for (const std::size_t threads : {1, 4}) {
      const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
      const PhantomSpec spec{directory / "c.nrrd", {.kind = info.kind, .size = 70}};
      write_phantom(spec);
      files.push_back(read_whole_file(spec.path));
    }
    EXPECT_EQ(files[0], files[1]) << info.name;
  }
}

TEST(WritePhantom, ReportsProgressToTheEnd) {
  const testing::TempDirectory directory;
  std::vector<double> shares;
  PhantomHooks hooks;
  hooks.progress = [&](double share) { shares.push_back(share); };
  write_phantom({directory / "d.nrrd", {.size = 40}}, hooks);
  ASSERT_GT(shares.size(), 1u);
  EXPECT_TRUE(std::is_sorted(shares.begin(), shares.end()));
  EXPECT_EQ(shares.back(), 1);
}

TEST(WritePhantom, LeavesNothingWhenCancelled) {
  const testing::TempDirectory directory;
  for (const std::string name : {"e.nrrd", "e.raw"}) {
    int asked = 0;
    PhantomHooks hooks;
    hooks.cancelled = [&] { return ++asked == 2; };
    EXPECT_THROW(write_phantom({directory / name, {.size = 40}}, hooks), Interrupted);
    EXPECT_TRUE(std::filesystem::is_empty(directory.path()));
  }
}

TEST(WritePhantom, HandsZarrToItsWriter) {
  const testing::TempDirectory directory;
  const PhantomSpec spec{directory / "f.zarr", {.size = 12}};
  EXPECT_THROW(write_phantom(spec), InputError);
  PhantomHooks hooks;
  int calls = 0;
  hooks.zarr = [&](const SampleSource& source, const std::filesystem::path& path) {
    ++calls;
    EXPECT_EQ(source.info().geometry.size, splat(12));
    EXPECT_EQ(path, spec.path);
  };
  write_phantom(spec, hooks);
  EXPECT_EQ(calls, 1);
}

TEST(WritePhantom, RefusesOtherExtensions) {
  const testing::TempDirectory directory;
  const std::string said = testing::error_text<InputError>([&] {
    write_phantom({directory / "g.tif", {}});
  });
  EXPECT_THAT(said, HasSubstr("g.tif"));
  EXPECT_THAT(said, HasSubstr(".nrrd, .nhdr, .raw or .zarr"));
  EXPECT_TRUE(std::filesystem::is_empty(directory.path()));
}

}  // namespace
}  // namespace voxweld
