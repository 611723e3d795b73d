// `voxweld clean` takes away what no run of the configs would use, and nothing else.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <fstream>
#include <set>

#include "storage/support/directory_lock.h"
#include "tests/pipeline/run/scene.h"

namespace voxweld::testing {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::IsSubsetOf;

std::set<std::string> names_in(const fs::path& folder) {
  std::set<std::string> names;
  std::error_code missing;
  for (const auto& entry : fs::directory_iterator(folder, missing))
    names.insert(entry.path().filename().string());
  return names;
}

Arguments clean(const std::vector<fs::path>& configs, const Arguments& options = {}) {
  Arguments arguments = {"clean"};
  for (const fs::path& config : configs) arguments.push_back(config.string());
  return arguments + options;
}

void expect_nothing_to_do(const fs::path& config, const fs::path& output) {
  VOXWELD_EXPECT_DONE(run_voxweld({"run", config.string()}));
  for (const auto& [stage, units] : units_run(output)) EXPECT_EQ(units, 0U) << stage;
}

// Another config of the same volume with the same work directory.
fs::path sharing_config(const Scene& scene) {
  fs::path path = scene.directory() / "other.toml";
  fs::copy_file(scene.config(), path);
  std::ofstream(path, std::ios::app)
      << fmt::format("\n[work]\ndirectory = \"{}\"\n[output]\nprecision = 0.02\n",
                     scene.work().filename().string());
  return path;
}

TEST(Clean, RemovesTheWorkOfEarlierSettings) {
  const Scene scene("sphere", 24);
  VOXWELD_EXPECT_DONE(scene.run({"simplify.tolerance=0.5"}));
  VOXWELD_EXPECT_DONE(scene.run());
  const std::set<std::string> before = names_in(scene.work());
  const Tree tree = output_tree(scene.output());

  const ProgramResult look = run_voxweld(clean({scene.config()}, {"--dry-run"}));
  VOXWELD_EXPECT_DONE(look);
  EXPECT_EQ(names_in(scene.work()), before);
  EXPECT_THAT(look.out, HasSubstr("would remove " + (scene.work() / "build-").string()));
  EXPECT_THAT(look.out, HasSubstr("would be freed, 5 folders stay; work there of configs that are "
                                  "not named goes too\n"));

  const ProgramResult done = run_voxweld(clean({scene.config()}));
  VOXWELD_EXPECT_DONE(done);
  EXPECT_THAT(done.out, HasSubstr(" freed, 5 folders stay"));
  const std::set<std::string> after = names_in(scene.work());
  EXPECT_EQ(after.size(), before.size() - 4);  // build, merge, stitch, encode
  EXPECT_THAT(after, IsSubsetOf(before));
  EXPECT_EQ(difference(tree, output_tree(scene.output())), "");
  expect_nothing_to_do(scene.config(), scene.output());
  EXPECT_THAT(run_voxweld(clean({scene.config()})).out, HasSubstr(": 0 B freed, 5 folders stay\n"));
}

TEST(Clean, KeepsWhatAnyOfTheNamedConfigsUses) {
  const Scene scene("sphere", 24);
  const fs::path other = sharing_config(scene);
  VOXWELD_EXPECT_DONE(scene.run());
  VOXWELD_EXPECT_DONE(run_voxweld({"run", other}));
  const std::set<std::string> both = names_in(scene.work());
  VOXWELD_EXPECT_DONE(run_voxweld(clean({scene.config(), other, scene.config()})));
  EXPECT_EQ(names_in(scene.work()), both);
  VOXWELD_EXPECT_DONE(run_voxweld(clean({other})));
  EXPECT_LT(names_in(scene.work()).size(), both.size());
  expect_nothing_to_do(other, scene.output("other"));
}

TEST(Clean, OfAllLeavesWhatIsNotOurs) {
  const Scene scene("sphere", 24);
  VOXWELD_EXPECT_DONE(scene.run());
  const Tree tree = output_tree(scene.output());
  std::ofstream(scene.work() / "notes.txt") << "mine";
  fs::create_directory(scene.directory() / "mine");
  std::ofstream(scene.directory() / "mine" / "file") << "mine";
  fs::create_directory_symlink(scene.directory() / "mine", scene.work() / "build-0123456789ab");
  VOXWELD_EXPECT_DONE(run_voxweld(clean({scene.config()}, {"--all"})));
  EXPECT_EQ(names_in(scene.work()), (std::set<std::string>{"notes.txt", "build-0123456789ab"}));
  EXPECT_TRUE(fs::exists(scene.directory() / "mine" / "file"));
  EXPECT_EQ(difference(tree, output_tree(scene.output())), "");
  fs::remove(scene.work() / "notes.txt");
  fs::remove(scene.work() / "build-0123456789ab");
  VOXWELD_EXPECT_DONE(run_voxweld(clean({scene.config()}, {"--all"})));
  EXPECT_FALSE(fs::exists(scene.work()));
  VOXWELD_EXPECT_DONE(scene.run());
}

TEST(Clean, KeepsWhatItCannotKnow) {
  const Scene scene("sphere", 24);
  VOXWELD_EXPECT_DONE(scene.run({"work.copy=true", "surface.isovalue=\"otsu\""}));
  const std::set<std::string> before = names_in(scene.work());
  const Settings recut = {"work.copy=true", "surface.isovalue=\"otsu\"", "work.chunk=16"};
  const ProgramResult result = run_voxweld(clean({scene.config()}) + set_options(recut));
  VOXWELD_EXPECT_DONE(result);
  EXPECT_THAT(result.out, HasSubstr("its input is not ingested as it is now"));
  EXPECT_EQ(names_in(scene.work()).size(), before.size() - 1);  // the earlier store
}

TEST(Clean, LeavesARunUnderWayAlone) {
  const Scene scene("sphere", 24);
  VOXWELD_EXPECT_DONE(scene.run({"simplify.tolerance=0.5"}));
  VOXWELD_EXPECT_DONE(scene.run());
  const std::set<std::string> before = names_in(scene.work());
  const DirectoryLock lock(scene.output(), "/elsewhere/other.toml", {});
  expect_refused(run_voxweld(clean({scene.config()})), "is writing it for /elsewhere/other.toml");
  EXPECT_EQ(names_in(scene.work()), before);
}

TEST(Clean, LeavesTheWorkOfAnotherConfigUnderWayAlone) {
  const Scene scene("sphere", 24);
  VOXWELD_EXPECT_DONE(scene.run({"simplify.tolerance=0.5"}));
  const std::set<std::string> before = names_in(scene.work());
  const fs::path build =
      files_ending(scene.work(), ".octree").at(0).parent_path().parent_path().parent_path();
  ASSERT_TRUE(build.filename().string().starts_with("build-")) << build;
  const DirectoryLock lock(build, "/elsewhere/other.toml", {});
  expect_refused(run_voxweld(clean({scene.config()})), "for /elsewhere/other.toml");
  EXPECT_EQ(names_in(scene.work()), before);
}

}  // namespace
}  // namespace voxweld::testing
