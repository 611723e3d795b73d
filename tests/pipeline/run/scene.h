// A volume, its config (without refine, unless a test asks for it) and the directories of its runs, in a folder that goes with the test.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <random>
#include <string>
#include <vector>

#include "pipeline/output/load.h"
#include "pipeline/output/verify.h"
#include "storage/types/box.h"
#include "storage/types/sample_type.h"
#include "tests/pipeline/run/program.h"
#include "tests/support/temp_directory.h"

namespace voxweld::testing {

using Settings = std::vector<std::string>;  // "table.key=value"

// What a run leaves for the user, as name -> hash: every file of the output directory but the
// report and the manifest, whose times differ; of that, as "manifest", what depends on the volume and the
// contouring parameters alone.
using Tree = std::map<std::string, std::string>;
Tree output_tree(const std::filesystem::path& output);
// Names that only one has or that differ; empty when the same.
std::string difference(const Tree& expected, const Tree& found);

// Raw samples of one of the program's types, little-endian, x fastest.
struct RawVolume {
  Index3 size;
  SampleType type = SampleType::u8;
  std::vector<std::byte> samples;
  double isovalue = 0;
  Vec3 spacing{1, 1, 1};

  std::int64_t index(Index3 at) const { return (at.z * size.y + at.y) * size.x + at.x; }
};
RawVolume noise_volume(Index3 size, unsigned seed);
// From a function of the sample's index.
template <class F>
RawVolume integer_volume(SampleType type, Index3 size, F&& label_at) {
  RawVolume volume{size, type, {}, 0};
  each_index(size, [&](Index3 at) {
    const auto label = static_cast<std::uint64_t>(label_at(at));
    for (std::size_t i = 0; i < sample_bytes(type); ++i)
      volume.samples.push_back(static_cast<std::byte>(label >> 8 * i & 255));
  });
  return volume;
}
// u8, the same; the isovalue is 128.
template <class F>
RawVolume volume_of(Index3 size, F&& value) {
  RawVolume volume = integer_volume(SampleType::u8, size, value);
  volume.isovalue = 128;
  return volume;
}

class Scene {
 public:
  Scene(const std::string& phantom, std::int64_t size);  // uint8, made by the program
  explicit Scene(const RawVolume& volume);

  // Directories by name, so that one scene may have several runs beside each other.
  std::filesystem::path work(const std::string& name = "scene") const;
  std::filesystem::path output(const std::string& name = "scene") const;
  std::filesystem::path volume() const { return volume_; }
  std::filesystem::path directory() const { return directory_.path(); }
  std::filesystem::path config() const { return directory_ / "scene.toml"; }
  void write_volume(const RawVolume& volume) const;  // over the one that is there

  ProgramResult command(const std::string& command, const Settings& settings = {},
                        std::optional<Stop> stop = {}) const;
  ProgramResult run(const Settings& settings = {}, std::optional<Stop> stop = {}) const {
    return command("run", settings, stop);
  }
  // Of one command, with options behind the settings.
  ProgramResult command_with(const std::string& command, const Settings& settings,
                             const Arguments& options) const {
    return run_voxweld(Arguments{command, config().string()} + set_options(settings) + options);
  }
  // The same into directories of that name.
  ProgramResult run_in(const std::string& name, const Settings& settings = {},
                       std::optional<Stop> stop = {}) const {
    return run(settings + in(name), stop);
  }
  Settings in(const std::string& name) const;
  // Runs into fresh directories, checks that it worked, and returns what came out.
  Tree clean_tree(const Settings& settings = {}) const;
  // Every variant beside the common settings leaves the same, which is returned.
  Tree expect_one_tree(const Settings& common, const std::vector<Settings>& variants) const;

  // What runs into directories of that name have left is gone.
  void forget(const std::string& name = "scene") const;
  // Of the work, what these stages have left.
  void forget_stages(const std::vector<std::string>& stages) const;

 private:
  void write_config(const std::string& input, const std::string& surface) const;

  TempDirectory directory_;
  std::filesystem::path volume_;
};

// No problem of the output directory's meshes is left.
VerifyReport expect_good(const std::filesystem::path& output);
// These words are in the messages.
void expect_says(const ProgramResult& result, const std::string& words);
void expect_refused(const ProgramResult& result, const std::string& words, int exit_code = 2);

std::string text_of_file(const std::filesystem::path& path);

// While it lives, commit_points.cpp watches what programs do in the scene's folder, and has these
// of its variables.
Environment watched(const Scene& scene, std::vector<std::pair<std::string, std::string>> variables);

nlohmann::json manifest_of(const std::filesystem::path& output);
// "build" -> how many units of it the last run did, those that it ran alone.
std::map<std::string, std::uint64_t> units_run(const std::filesystem::path& output);

double enclosed_volume(const DecodedMesh& mesh);  // of a closed one

// All files below `root` whose name ends so, sorted.
std::vector<std::filesystem::path> files_ending(const std::filesystem::path& root,
                                                const std::string& ending);
std::vector<std::filesystem::path> temporary_files(const std::filesystem::path& root);

}  // namespace voxweld::testing

// The run ended well; its messages if not.
#define VOXWELD_EXPECT_DONE(result)                                     \
  do {                                                                  \
    const ::voxweld::testing::ProgramResult& checked_result = (result); \
    EXPECT_EQ(checked_result.exit_code, 0) << checked_result.err;       \
  } while (false)
