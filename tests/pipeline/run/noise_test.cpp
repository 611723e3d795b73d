// surface.gradient = "auto": the samples' noise is measured once a volume.
#include <fstream>

#include "storage/artifact/noise_artifact.h"
#include "tests/pipeline/run/scene.h"

namespace voxweld::testing {
namespace {

// A cube turned a little, some 25 steps a voxel, with noise of that many steps.
RawVolume cube_with_noise(unsigned steps) {
  std::mt19937 random(3);
  return volume_of({70, 66, 68}, [&](Index3 p) {
    const std::int64_t x = p.x - 34, y = p.y - 33, z = p.z - 33;
    const std::int64_t distance = std::max(
        {std::abs(24 * x + 6 * y), std::abs(24 * y - 6 * x + 3 * z), std::abs(24 * z - 3 * y)});
    const std::int64_t noise =
        steps == 0 ? 0 : static_cast<std::int64_t>(random() % (2 * steps + 1)) - steps;
    return std::clamp<std::int64_t>(128 + 500 - distance + noise, 0, 255);
  });
}

const Settings automatic = {"surface.gradient=auto", "work.brick=16", "work.shard=2"};

std::filesystem::path noise_file(const Scene& scene) {
  std::vector<std::filesystem::path> found;
  for (const auto& file : files_ending(scene.work(), ""))
    if (file.filename().string().starts_with("noise-")) found.push_back(file);
  EXPECT_EQ(found.size(), 1U);
  return found.empty() ? std::filesystem::path() : found.front();
}
double noise_of(const Scene& scene) {
  return read_noise_artifact(noise_file(scene)).level;
}

TEST(Noise, IsMeasuredAndToldInTheManifest) {
  for (const auto& [steps, lowest, highest] :
       {std::tuple{0U, 0.2, 0.5}, std::tuple{6U, 2.0, 6.0}}) {
    const Scene scene(cube_with_noise(steps));
    VOXWELD_EXPECT_DONE(scene.run(automatic));
    EXPECT_GE(noise_of(scene), lowest);
    EXPECT_LE(noise_of(scene), highest);
    EXPECT_EQ(manifest_of(scene.output()).at("input").at("noise"), noise_of(scene));
    expect_good(scene.output());
  }
}

TEST(Noise, IsTheSameHoweverTheVolumeIsRead) {
  const Scene scene(cube_with_noise(4));
  const std::vector<Settings> ways = {{"work.copy=false"},
                                      {"work.copy=true"},
                                      {"work.copy=true", "work.chunk=8"},
                                      {"work.brick=16", "run.threads=1"}};
  const Tree plain = scene.expect_one_tree({"surface.gradient=auto"}, ways);
  std::ofstream(scene.config(), std::ios::app) << "\n[[filter]]\ntype = \"median\"\nradius = 1\n";
  EXPECT_NE(difference(plain, scene.expect_one_tree({"surface.gradient=auto"}, ways)), "");
}

TEST(Noise, IsKeptForTheNextRun) {
  const Scene scene(cube_with_noise(4));
  VOXWELD_EXPECT_DONE(scene.run(automatic));
  const auto measured = std::filesystem::last_write_time(noise_file(scene));
  VOXWELD_EXPECT_DONE(scene.run(automatic));
  for (const auto& [stage, units] : units_run(scene.output())) EXPECT_EQ(units, 0U) << stage;
  EXPECT_EQ(std::filesystem::last_write_time(noise_file(scene)), measured);
}

TEST(Noise, ADamagedRecordIsMeasuredAgain) {
  const Scene scene(cube_with_noise(4));
  VOXWELD_EXPECT_DONE(scene.run(automatic));
  const double level = noise_of(scene);
  std::filesystem::resize_file(noise_file(scene), 40);
  VOXWELD_EXPECT_DONE(scene.run(automatic));
  EXPECT_EQ(noise_of(scene), level);
}

TEST(Noise, OfAnotherInputIsMeasuredAnew) {
  const Scene scene(cube_with_noise(0));
  VOXWELD_EXPECT_DONE(scene.run(automatic));
  const double before = noise_of(scene);
  scene.write_volume(cube_with_noise(10));
  VOXWELD_EXPECT_DONE(scene.run(automatic));
  EXPECT_GT(noise_of(scene), 4 * before);
  const Tree found = output_tree(scene.output());
  EXPECT_EQ(difference(Scene(cube_with_noise(10)).clean_tree(automatic), found), "");
}

}  // namespace
}  // namespace voxweld::testing
