// What every kind of run that refines has to bear: stages that are forgotten, damage, kills.
#pragma once

#include <fmt/format.h>

#include <csignal>
#include <random>

#include "storage/support/file_io.h"
#include "tests/pipeline/run/edit_scene.h"

namespace voxweld::testing {

inline const std::vector<std::string> refine_stages = {"refine", "seams", "mend", "remend",
                                                       "retile"};

inline std::vector<std::filesystem::path> artifacts_of(const Scene& scene, const std::string& stage,
                                                       const std::string& ending) {
  std::vector<std::filesystem::path> found = files_ending(scene.work(), ending);
  std::erase_if(found, [&](const std::filesystem::path& path) {
    return path.string().find("/" + stage + "-") == std::string::npos;
  });
  return found;
}

// The files of the merged mesh.
inline Tree merged_files(const Tree& tree) {
  Tree merged;
  for (const char* name : {"mesh.drc", "mesh.glb"})
    if (tree.contains(name)) merged[name] = tree.at(name);
  EXPECT_EQ(merged.size(), 2u);
  return merged;
}

// Runs again after each of the stages was forgotten. What comes out of it is the same, so nothing
// behind it is done again. clean: the output that there is to be.
inline void expect_goes_on(const Scene& scene, const Settings& settings, const Tree& clean,
                           const std::vector<std::string>& stages) {
  VOXWELD_EXPECT_DONE(scene.run(settings));
  for (const std::string& stage : stages) {
    scene.forget_stages({stage});
    VOXWELD_EXPECT_DONE(scene.run(settings));
    EXPECT_EQ(difference(clean, output_tree(scene.output())), "") << stage;
    for (const auto& [name, ran] : units_run(scene.output()))
      EXPECT_EQ(ran > 0, name == stage) << name << " after " << stage;
  }
}

// An artifact, and the stage that reads it.
struct ReadArtifact {
  std::string stage, ending, reader;
};

inline const std::vector<ReadArtifact> refine_artifacts = {
    {"stitch", ".cubes", "refine"}, {"refine", ".cubes", "seams"},
    {"seams", ".cubes", "mend"},    {"mend", ".cubes", "remend"},
    {"remend", ".cubes", "retile"}, {"retile", "tile.plan", "encode"},
    {"retile", ".tile", "encode"}};

// Changes a byte of one of each, some times, and runs again.
inline void expect_damage_is_mended(const Scene& scene, const Settings& settings, int times,
                                    const std::vector<ReadArtifact>& artifacts) {
  VOXWELD_EXPECT_DONE(scene.run(settings));
  const Tree clean = output_tree(scene.output());
  std::mt19937 random(3);
  for (const auto& [stage, ending, reader] : artifacts)
    for (int time = 0; time < times; ++time) {
      SCOPED_TRACE(fmt::format("{} {}", stage, ending));
      const auto files = artifacts_of(scene, stage, ending);
      ASSERT_FALSE(files.empty());
      const std::filesystem::path& file = files[random() % files.size()];
      auto bytes = read_whole_file(file);
      bytes[random() % bytes.size()] ^= std::byte{4};
      write_whole_file(file, bytes, Durability::rename_only);
      // All that reads it is to be done.
      if (stage != reader) scene.forget_stages({reader});
      VOXWELD_EXPECT_DONE(scene.run(settings));
      EXPECT_EQ(difference(clean, output_tree(scene.output())), "");
      const ProgramResult again = scene.command_with("run", settings, {"--dry-run"});
      EXPECT_EQ(again.out.find("would run"), std::string::npos) << again.out;
    }
}

// Kills runs, each after this part of a whole one's time at least.
inline void expect_kills_lose_nothing(const Scene& scene, const Settings& settings, int kills,
                                      double least) {
  const Tree clean = scene.clean_tree(settings);
  const ProgramResult undisturbed = scene.run_in("timing", settings);
  VOXWELD_EXPECT_DONE(undisturbed);
  std::mt19937 random(9);
  int killed = 0;
  for (int i = 0; i < kills; ++i) {
    std::uniform_real_distribution<double> moment(least * undisturbed.seconds, undisturbed.seconds);
    const ProgramResult result = scene.run(settings, Stop{SIGKILL, moment(random)});
    if (result.exit_code == 128 + SIGKILL)
      ++killed;
    else
      scene.forget();
  }
  EXPECT_GT(killed, 0);
  VOXWELD_EXPECT_DONE(scene.run(settings));
  EXPECT_EQ(difference(clean, output_tree(scene.output())), "");
  EXPECT_TRUE(temporary_files(scene.work()).empty());
}

}  // namespace voxweld::testing
