// What is promised of every run, of runs on labels, with edits and on meshes: one table of what may
// go in, and for each the bytes of a clean run whatever the partition, the shares, kills and
// damage.

#include <csignal>
#include <fstream>
#include <functional>

#include "storage/support/file_io.h"
#include "tests/pipeline/run/label_volumes.h"
#include "tests/pipeline/run/mesh_scene.h"
#include "tests/support/triangle_meshes.h"

namespace voxweld::testing {
namespace {

namespace fs = std::filesystem;

std::string solid(const std::string& op, const std::string& shape) {
  return "[[edit]]\nop = \"" + op + "\"\n" + shape;
}
const std::string ball_keys = "shape = \"sphere\"\ncenter = [14.2, 15.1, 18.3]\nradius = 7.4\n";
const std::string slab_keys =
    "shape = \"box\"\ncenter = [24.3, 15.2, 16.1]\nsize = [11, 13.5, 30]\nrotate = [20, 10, 0]\n";
const std::string part_keys = "shape = \"mesh\"\npath = \"part.off\"\n";

const std::string edits_of_labels = solid("add", "material = 3\n" + ball_keys) +
                                    solid("replace", "material = 90\n" + slab_keys) +
                                    solid("subtract", part_keys);

struct Subject {
  std::string name;
  std::function<RawVolume()> volume;
  std::string more;  // of the config; all of it where it is a mesh's
  Settings settings;
  bool is_mesh = false;
  bool is_refined = false;

  bool has_labels() const {
    return std::ranges::any_of(settings, [](const auto& s) { return s.starts_with("labels."); });
  }
};

RawVolume few_labels() {
  return cell_labels({38, 34, 33}, 5, 0.003, 21);
}

std::vector<Subject> subjects() {
  const auto noise = [] { return noise_volume({34, 30, 33}, 9); };
  const std::string mesh =
      "[input]\npath = \"input.off\"\nresolution = 40\n[run]\nthreads = 2\n" +
      solid("subtract", "shape = \"sphere\"\ncenter = [20, 12, 12]\nradius = 7\n");
  std::vector<Subject> all = {
      {"EachLabel", few_labels, edits_of_labels, {"labels.mode=each"}},
      {"SharedLabels", few_labels, edits_of_labels, {"labels.mode=shared"}},
      {"EditedVolume",
       noise,
       solid("subtract", ball_keys) + solid("add", part_keys) + solid("intersect", slab_keys),
       {}},
      {"Mesh", noise, mesh, {"simplify.refine=off"}, true},
  };
  // Where a node's sheets collapse all or not.
  Subject safe = all[2];
  safe.name = "SafeEditedVolume";
  safe.settings = {"simplify.topology=safe", "simplify.tolerance=0.4"};
  all.push_back(safe);
  safe = all[0];
  safe.name = "SafeEachLabel";
  safe.settings = safe.settings + Settings{"simplify.topology=safe"};
  all.push_back(safe);
  // A tolerance at which there are several tiles.
  for (std::size_t i = 0, plain = all.size(); i < plain; ++i) {
    Subject refined = all[i];
    refined.name = "Refined" + refined.name;
    refined.is_refined = true;
    refined.settings =
        refined.settings + Settings{"simplify.refine=auto", "simplify.tolerance=0.001"};
    all.push_back(refined);
  }
  return all;
}

void PrintTo(const Subject& subject, std::ostream* out) {
  *out << subject.name;
}

class Invariants : public ::testing::TestWithParam<Subject> {
 protected:
  Invariants() : scene_(GetParam().volume()) {
    write_off(scene_.directory() / "part.off", dented_ball({22, 20, 15}, 6, 3));
    write_off(scene_.directory() / "input.off", dented_ball({12, 12, 12}, 11, 4));
    std::ofstream(scene_.config(), GetParam().is_mesh ? std::ios::trunc : std::ios::app)
        << "\n"
        << GetParam().more;
  }
  // Several shards and tiles.
  Settings settings() const {
    return Settings{"work.brick=16", "work.shard=1", "work.chunk=16", "output.tile_vertices=1024"} +
           GetParam().settings;
  }
  Tree tree() const { return output_tree(scene_.output()); }

  const Scene scene_;
};

TEST_P(Invariants, EveryPartitionGivesTheSameBytes) {
  const Settings common = GetParam().settings + Settings{"output.tile_vertices=1024"};
  const Tree first = scene_.expect_one_tree(
      common, {Settings{"work.brick=16", "work.shard=1", "work.chunk=16", "run.threads=1"},
               Settings{"work.brick=16", "work.shard=4", "work.chunk=8", "work.copy=true"},
               Settings{"work.brick=32", "work.shard=1"}});
  EXPECT_GT(first.size(), 8u);
  VOXWELD_EXPECT_DONE(scene_.run(settings()));
  expect_good(scene_.output());
}

TEST_P(Invariants, AllSharesAreTheWhole) {
  const auto share = [&](const std::string& stage, const std::vector<std::string>& options) {
    VOXWELD_EXPECT_DONE(scene_.command_with(stage, settings() + scene_.in("shares"), options));
  };
  for (const std::string stage : {"ingest", "build", "merge", "stitch", "refine", "seams", "mend",
                                  "remend", "retile", "encode"}) {
    const bool of_refined = stage == "refine" || stage == "seams" || stage == "mend" ||
                            stage == "remend" || stage == "retile";
    if (of_refined && !GetParam().is_refined) continue;
    if (stage != "merge")
      for (const char* which : {"1/2", "0/2"}) share(stage, {"--part", which});
    share(stage, {});
  }
  EXPECT_EQ(difference(scene_.clean_tree(settings()), output_tree(scene_.output("shares"))), "");
}

TEST_P(Invariants, KilledAtAnyMomentItEndsInTheSameBytes) {
  const Tree clean = scene_.clean_tree(settings());
  const ProgramResult undisturbed = scene_.run_in("timing", settings());
  VOXWELD_EXPECT_DONE(undisturbed);
  std::mt19937 random(22);
  std::uniform_real_distribution<double> moment(0, undisturbed.seconds);
  for (int i = 0; i < 4; ++i) {
    const ProgramResult result = scene_.run(settings(), Stop{SIGKILL, moment(random)});
    if (result.exit_code == 128 + SIGKILL) continue;
    VOXWELD_EXPECT_DONE(result);  // it was done before the moment came
    fs::remove_all(i % 2 == 0 ? scene_.work() : scene_.output());
  }
  VOXWELD_EXPECT_DONE(scene_.run(settings()));
  EXPECT_EQ(difference(clean, tree()), "");
  EXPECT_TRUE(temporary_files(scene_.work()).empty());
  EXPECT_TRUE(temporary_files(scene_.output()).empty());
}

using Bytes = std::vector<std::byte>;

// Turns a bit around, cuts, or empties, in turns.
void damage(const fs::path& file, int how, std::mt19937& random) {
  Bytes bytes = read_whole_file(file);
  if (how == 0 && !bytes.empty())
    bytes[random() % bytes.size()] ^= std::byte(1u << (random() % 8));
  else
    bytes.resize(how == 1 ? random() % std::max<std::size_t>(1, bytes.size()) : 0);
  write_whole_file(file, bytes, Durability::rename_only);
}

// What follows from build goes, so that the octrees are read and not only looked at.
void forget_behind_build(const fs::path& work) {
  for (const auto& entry : fs::directory_iterator(work))
    for (const char* stage :
         {"merge-", "stitch-", "refine-", "seams-", "mend-", "remend-", "retile-", "encode-"})
      if (entry.path().filename().string().starts_with(stage)) fs::remove_all(entry.path());
}

TEST_P(Invariants, DamageIsMended) {
  VOXWELD_EXPECT_DONE(scene_.run(settings()));
  const Tree clean = tree();
  std::mt19937 random(23);
  int turn = 0;
  for (const char* ending :
       {".octree", "top.tree", ".cubes", "tile.plan", ".tile", ".record", "labels.all", ".labels",
        ".drc", ".glb", "manifest.json", "tiles.jsonl", "labels.jsonl"}) {
    auto files = files_ending(scene_.work(), ending);
    if (files.empty()) files = files_ending(scene_.output(), ending);
    const bool of_labels = std::string(ending).find("labels") != std::string::npos;
    const bool of_refined = std::string(ending) == ".cubes" || std::string(ending) == "tile.plan";
    ASSERT_EQ(files.empty(),
              (of_labels && !GetParam().has_labels()) || (of_refined && !GetParam().is_refined))
        << ending;
    if (files.empty()) continue;
    const fs::path& file = files[random() % files.size()];
    damage(file, turn++ % 3, random);
    SCOPED_TRACE(file.string());
    VOXWELD_EXPECT_DONE(scene_.run(settings()));
    EXPECT_EQ(difference(clean, tree()), "");
  }
  for (int i = 0; i < 3; ++i) {
    const auto octrees = files_ending(scene_.work(), ".octree");
    damage(octrees[random() % octrees.size()], i, random);
    forget_behind_build(scene_.work());
    VOXWELD_EXPECT_DONE(scene_.run(settings()));
    EXPECT_EQ(difference(clean, tree()), "");
  }
}

// In what comes behind the header, which a look at the keys does not read; and, of labels, behind
// the first piece's head, which only build reads.
TEST_P(Invariants, DamageIsNamedAndRefusedByASingleStage) {
  VOXWELD_EXPECT_DONE(scene_.run(settings()));
  const auto octrees = files_ending(scene_.work(), ".octree");
  const auto largest = std::max_element(
      octrees.begin(), octrees.end(),
      [](const fs::path& a, const fs::path& b) { return fs::file_size(a) < fs::file_size(b); });
  Bytes bytes = read_whole_file(*largest);
  bytes[416] ^= std::byte{1};
  write_whole_file(*largest, bytes, Durability::rename_only);
  const Settings changed = settings() + Settings{"output.precision=0.1"};
  const ProgramResult refused = scene_.command("stitch", changed);
  expect_refused(refused, largest->string() + ": the checksum of", 1);
  const ProgramResult mended = scene_.run(changed);
  VOXWELD_EXPECT_DONE(mended);
  expect_says(mended, "it is removed and made again");
  EXPECT_EQ(difference(scene_.clean_tree(changed), tree()), "");
}

TEST_P(Invariants, NothingIsDoneTwice) {
  VOXWELD_EXPECT_DONE(scene_.run(settings()));
  const Tree first = tree();
  VOXWELD_EXPECT_DONE(scene_.run(settings()));
  for (const auto& [stage, ran] : units_run(scene_.output())) EXPECT_EQ(ran, 0u) << stage;
  EXPECT_EQ(difference(first, tree()), "");
}

INSTANTIATE_TEST_SUITE_P(Of, Invariants, ::testing::ValuesIn(subjects()),
                         [](const auto& each) { return each.param.name; });

}  // namespace
}  // namespace voxweld::testing
