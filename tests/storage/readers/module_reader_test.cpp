// Formats that live in modules: libvoxweld_made_up.so and libvoxweld_old.so beside this program.
#include <cstdlib>
#include <fstream>

#include "tests/storage/volumes/known_volume.h"

namespace voxweld::testing {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::vector<VolumeReader> readers_with(const VolumeReader& added) {
  std::vector<VolumeReader> readers(volume_readers().begin(), volume_readers().end());
  readers.push_back(added);
  return readers;
}

VolumeReader made_up() {
  VolumeReader reader;
  reader.name = "made_up";
  reader.files = ".mup";
  reader.test = [](const InputProbe& probe) {
    return probe.extension == ".mup" ? Match::extension : Match::none;
  };
  reader.module = "made_up";
  return reader;
}

template <class Failure>
std::string failure_of(const std::filesystem::path& path, const VolumeReader& reader = made_up()) {
  try {
    const auto source = open_volume({.path = path.string()}, readers_with(reader));
    read_box(*source, {{}, source->info().geometry.size});
  } catch (const Failure& failure) {
    return failure.what();
  }
  return {};
}

bool mapped(const std::string& library) {
  std::ifstream maps("/proc/self/maps");
  for (std::string line; std::getline(maps, line);)
    if (line.find(library) != std::string::npos) return true;
  return false;
}

class ModuleReader : public ::testing::Test {
 protected:
  std::filesystem::path file(const std::string& contents) const {
    return write_file(directory_ / "a.mup", to_bytes(contents));
  }
  const TempDirectory directory_;
};

TEST_F(ModuleReader, IsLoadedByItsOwnFilesAlone) {
  const auto text = write_file(directory_ / "a.txt", std::string("some text"));
  EXPECT_THAT(failure_of<InputError>(text), HasSubstr("hdf5, vdb, stack, made_up."));
  const bool first = !mapped("libvoxweld_made_up.so");
  failure_of<Error>(file("MADE-UP 1 1 1\nx"));
  EXPECT_TRUE(mapped("libvoxweld_made_up.so"));
  // Where each case has a process of its own, as with ctest, this one comes first.
  const bool alone = ::testing::UnitTest::GetInstance()->test_to_run_count() == 1;
  EXPECT_TRUE(first || !alone);
}

TEST_F(ModuleReader, ReadsAVolume) {
  const KnownVolume volume = make_volume(SampleType::u8, {3, 4, 5});
  const auto path = write_file(directory_ / "a.mup", to_bytes("MADE-UP 3 4 5\n") + volume.stored());
  const auto readers = readers_with(made_up());
  const auto source = open_volume({.path = path.string()}, readers);
  EXPECT_EQ(source->info().format, "made_up");
  EXPECT_THAT(source->info().warnings, ElementsAre(path.string() + ": of a format nobody has"));
  expect_volume(*source, volume);
  InputSpec spec{.path = path.string(), .format = "made_up"};
  spec.crop = Box3{{1, 0, 2}, {3, 4, 4}};
  EXPECT_EQ(read_box(*open_volume(spec, readers), {{}, {2, 4, 2}}), volume.box(*spec.crop));
}

TEST_F(ModuleReader, WhatItThrowsIsThrownHere) {
  EXPECT_THAT(failure_of<FormatError>(file("MADE-UP 1\n")), HasSubstr("a.mup: no sizes"));
  EXPECT_THAT(failure_of<FormatError>(file("MADE-UP 2 2 2\nxxx")),
              HasSubstr("a.mup: is cut short"));
  EXPECT_THAT(failure_of<InputError>(file("MADE-UP 1 1 0\n")), HasSubstr("a.mup: has no slices"));
  EXPECT_THAT(failure_of<StorageError>(directory_ / "none.mup"), HasSubstr("none.mup"));
  EXPECT_THAT(failure_of<StorageError>(file("MADE-UP 1 1 -1\n")),
              HasSubstr("a.mup: out of memory"));
  EXPECT_THAT(failure_of<FormatError>(file("MADE-UP 1 1 -2\n")),
              HasSubstr("a.mup: cannot be read: a library's words"));
  EXPECT_THAT(failure_of<FormatError>(file("MADE-UP 1 1 -3\n")),
              HasSubstr("a.mup: cannot be read, and its library does not say why"));
}

TEST_F(ModuleReader, NamesAModuleThatIsMissing) {
  VolumeReader reader = made_up();
  reader.module = "nowhere";
  setenv("VOXWELD_MODULES", directory_.path().c_str(), 1);
  const std::string said = failure_of<InputError>(file("MADE-UP 1 1 1\nx"), reader);
  unsetenv("VOXWELD_MODULES");
  EXPECT_THAT(said, AllOf(HasSubstr("cannot find the module libvoxweld_nowhere.so"),
                          HasSubstr("needed to read " + (directory_ / "a.mup").string()),
                          HasSubstr("looked in " + directory_.path().string() + ", "),
                          HasSubstr("/lib/voxweld; install it"), HasSubstr("VOXWELD_MODULES")));
}

TEST_F(ModuleReader, RefusesAModuleOfAnotherBuild) {
  VolumeReader reader = made_up();
  reader.module = "old";
  EXPECT_THAT(failure_of<InputError>(file("MADE-UP 1 1 1\nx"), reader),
              AllOf(HasSubstr("libvoxweld_old.so belongs to another build"),
                    HasSubstr("expected interface " VOXWELD_VERSION "/"),
                    HasSubstr("found 0.0.1/1"), HasSubstr("that came with this program")));
}

TEST_F(ModuleReader, NamesAReaderThatItsModuleLacks) {
  VolumeReader reader = made_up();
  reader.name = "other";
  EXPECT_THAT(failure_of<InputError>(file("MADE-UP 1 1 1\nx"), reader),
              HasSubstr("the module made_up has no reader other, but made_up"));
}

}  // namespace
}  // namespace voxweld::testing
