// What cannot work is refused: exit code 2 for what the user can mend, one clear message on
// standard error, and no output that looks like a result.
#include <fmt/format.h>
#include <sys/mount.h>
#include <unistd.h>

#include <fstream>
#include <regex>

#include "tests/pipeline/run/scene.h"

namespace voxweld::testing {
namespace {

namespace fs = std::filesystem;

RawVolume ball_volume(std::int64_t n) {
  return volume_of({n, n, n}, [=](Index3 at) {
    const Index3 d = at - splat(n / 2);
    return std::max<std::int64_t>(10, 230 - 3 * (d.x * d.x + d.y * d.y + d.z * d.z));
  });
}

int lines_of_kind(const std::string& text, const std::string& kind) {
  std::istringstream lines(text);
  int count = 0;
  for (std::string line; std::getline(lines, line);) count += line.starts_with(kind) ? 1 : 0;
  return count;
}

// Refused with one message, in which each of `words` appears, and nothing written for the user.
void expect_refused(const Scene& scene, const ProgramResult& result,
                    const std::vector<std::string>& words, int exit_code = 2) {
  EXPECT_EQ(result.exit_code, exit_code) << result.err;
  EXPECT_EQ(lines_of_kind(result.err, "error: "), 1) << result.err;
  for (const std::string& word : words)
    EXPECT_NE(result.err.find(word), std::string::npos) << word << " is not in: " << result.err;
  EXPECT_EQ(result.err.find("internal error"), std::string::npos) << result.err;
  EXPECT_EQ(result.out, "");
  EXPECT_TRUE(output_tree(scene.output()).empty());
}

TEST(BadInput, AnIsovalueOutsideTheData) {
  const Scene scene(ball_volume(24));  // values 10 to 230
  for (const char* copy : {"work.copy=false", "work.copy=true"}) {
    expect_refused(scene, scene.run({"surface.isovalue=231", copy}),
                   {"surface.isovalue = 231", "from 10 to 230", scene.volume().string()});
    expect_refused(scene, scene.run({"surface.isovalue=9", "surface.inside=below", copy}),
                   {"surface.isovalue = 9", "from 10 to 230"});
  }
  VOXWELD_EXPECT_DONE(scene.run());  // and after that it works
}

TEST(BadInput, AConstantVolumeHasNoThresholdToFind) {
  const Scene scene(volume_of({20, 20, 20}, [](Index3) { return 7; }));
  expect_refused(scene, scene.run({"surface.isovalue=otsu"}), {"otsu", "one value"});
}

TEST(BadInput, AMissingVolume) {
  const Scene scene(ball_volume(16));
  fs::remove(scene.volume());
  expect_refused(scene, scene.run(), {scene.volume().string()});
}

TEST(BadInput, AMissingConfig) {
  const ProgramResult result = run_voxweld({"run", "no-such-config.toml"});
  expect_refused(result, "no-such-config.toml");
}

// Linux names files by any bytes; the manifest is UTF-8.
TEST(BadInput, NamesThatAreNotUtf8AreNone) {
  const Scene scene(ball_volume(24));
  VOXWELD_EXPECT_DONE(scene.run());
  const Tree expected = output_tree(scene.output());
  const fs::path odd = scene.directory() / "caf\xe9";
  fs::create_directories(odd);
  for (const fs::path& file : {scene.config(), scene.volume()})
    fs::rename(file, odd / file.filename());
  VOXWELD_EXPECT_DONE(run_voxweld({"run", odd / scene.config().filename()}));
  const fs::path output = odd / scene.output().filename();
  EXPECT_EQ(difference(expected, output_tree(output)), "");
  VOXWELD_EXPECT_DONE(run_voxweld({"verify", output}));
  for (const Settings& asks : {Settings{"info", output.string(), "--json"},
                               {"plan", (odd / scene.config().filename()).string(), "--json"},
                               {"status", (odd / scene.config().filename()).string(), "--json"}})
    VOXWELD_EXPECT_DONE(run_voxweld(asks));
}

TEST(BadInput, ATruncatedVolume) {
  const Scene scene(ball_volume(16));
  fs::resize_file(scene.volume(), 16 * 16 * 16 - 1);
  expect_refused(scene, scene.run(), {scene.volume().string(), "4096", "4095"});
}

// Bytes after the samples may be a footer: a warning, and the same result.
TEST(BadInput, AVolumeThatIsLongerThanItsSizeIsWarnedOf) {
  const Scene scene(ball_volume(16));
  const Tree exact = scene.clean_tree();
  std::ofstream(scene.volume(), std::ios::app) << "more";
  const ProgramResult result = scene.run();
  VOXWELD_EXPECT_DONE(result);
  EXPECT_EQ(lines_of_kind(result.err, "warning: "), 1) << result.err;
  EXPECT_EQ(difference(exact, output_tree(scene.output())), "");
}

TEST(BadInput, DirectoriesThatCannotBe) {
  const Scene scene(ball_volume(16));
  std::ofstream(scene.directory() / "file") << "not a directory";
  const std::string below = (scene.directory() / "file" / "below").string();
  expect_refused(scene, scene.run({"work.directory=" + below}), {"work.directory", below});
  expect_refused(scene, scene.run({"output.directory=" + below}), {"output.directory", below});
  EXPECT_FALSE(fs::exists(scene.work()));
}

// A small file system of its own, while it lives.
class SmallDisk {
 public:
  SmallDisk(const fs::path& at, const std::string& size, unsigned long flags = 0) : at_(at) {
    fs::create_directory(at);
    mounted_ = mount("tmpfs", at.c_str(), "tmpfs", flags, ("size=" + size).c_str()) == 0;
  }
  ~SmallDisk() {
    if (mounted_) umount(at_.c_str());
  }
  SmallDisk(const SmallDisk&) = delete;
  SmallDisk& operator=(const SmallDisk&) = delete;
  bool mounted() const { return mounted_; }
  const fs::path& path() const { return at_; }

 private:
  fs::path at_;
  bool mounted_ = false;
};

TEST(BadInput, DirectoriesThatMayNotBeWritten) {
  const Scene scene(ball_volume(16));
  const fs::path locked = scene.directory() / "locked";
  const SmallDisk disk(locked, "1m", MS_RDONLY);  // root may write everywhere else
  if (!disk.mounted() && geteuid() == 0) GTEST_SKIP() << "needs the right to mount a tmpfs";
  if (!disk.mounted()) fs::permissions(locked, fs::perms::owner_read | fs::perms::owner_exec);
  const std::string below = (locked / "below").string();
  expect_refused(scene, scene.run({"work.directory=" + below}), {"work.directory", below});
  expect_refused(scene, scene.run({"output.directory=" + below}), {"output.directory", below});
  EXPECT_FALSE(fs::exists(scene.work()));
}

// The figure in the message is one that works, at once, for all stages.
TEST(BadInput, TooLittleMemory) {
  const Scene scene("part", 64);
  const std::vector<Settings> variants = {
      {"run.memory=64MiB", "work.brick=256"},
      {"run.memory=64MiB", "work.brick=64"},
      {"run.memory=64MiB", "work.copy=true", "work.chunk=256", "work.brick=256"},
      {"run.memory=100MiB", "work.brick=128", "output.tile_vertices=1000000"}};
  for (const Settings& settings : variants) {
    const ProgramResult result = scene.run(settings);
    expect_refused(scene, result, {"run.memory", "too small", "stage "});
    const std::regex figure("needs at least ([0-9]+MiB)");
    std::smatch found;
    ASSERT_TRUE(std::regex_search(result.err, found, figure)) << result.err;
    VOXWELD_EXPECT_DONE(scene.run(settings + Settings{"run.memory=" + found[1].str()}));
    scene.forget();
  }
}

TEST(BadInput, AMergedMeshThatDoesNotFit) {
  const Scene scene(noise_volume({70, 70, 70}, 1));
  const Settings settings = {"run.memory=128MiB", "work.brick=32", "output.tile_vertices=20000",
                             "simplify.enabled=false"};
  const ProgramResult result = scene.run(settings + Settings{"output.merged=true"});
  expect_refused(result, "output.merged = true");
  EXPECT_FALSE(fs::exists(scene.output() / "manifest.json"));
  EXPECT_FALSE(fs::exists(scene.output() / "mesh.drc"));
  const ProgramResult without = scene.run(settings);  // "auto" leaves it out and says so
  VOXWELD_EXPECT_DONE(without);
  expect_says(without, "no merged mesh");
  EXPECT_TRUE(manifest_of(scene.output()).at("merged").is_null());
}

// Fills all but `left` bytes.
fs::path fill(const SmallDisk& disk, std::uintmax_t left) {
  const fs::path ballast = disk.path() / "ballast";
  std::ofstream out(ballast, std::ios::binary);
  const std::string piece(4096, 'x');
  while (fs::space(disk.path()).available > left) out << piece << std::flush;
  return ballast;
}

TEST(BadInput, AFullDisk) {
  const Scene scene("porous", 48);
  const SmallDisk disk(scene.directory() / "disk", "64m");
  if (!disk.mounted()) GTEST_SKIP() << "needs the right to mount a tmpfs";
  const Settings settings = {"work.brick=16", "work.shard=2", "work.copy=true",
                             "output.tile_vertices=1024"};
  const Tree clean = scene.clean_tree(settings);
  // Where the disk is full first depends on what is left: at the work directory, then the output.
  for (const char* key : {"work.directory", "output.directory"}) {
    int full = 0;
    for (std::uintmax_t left = 8192; left <= (1u << 20); left *= 4) {
      SCOPED_TRACE(fmt::format("{} with {} bytes left", key, left));
      const fs::path place = disk.path() / "run";
      const Settings there = settings + Settings{fmt::format("{}={}", key, place.string())};
      const fs::path output = std::string(key) == "output.directory" ? place : scene.output();
      const fs::path ballast = fill(disk, left);
      const ProgramResult result = scene.run(there);
      if (result.exit_code != 0) {
        ++full;
        EXPECT_EQ(result.exit_code, 1) << result.err;
        expect_says(result, disk.path().string());
        expect_says(result, "No space left");
        EXPECT_FALSE(fs::exists(output / "manifest.json"));
        EXPECT_TRUE(temporary_files(disk.path()).empty());
      }
      fs::remove(ballast);
      VOXWELD_EXPECT_DONE(scene.run(there));
      EXPECT_EQ(difference(clean, output_tree(output)), "");
      for (const fs::path& made : {place, scene.work(), scene.output()}) fs::remove_all(made);
    }
    EXPECT_GE(full, 2) << key;
  }
}

}  // namespace
}  // namespace voxweld::testing
