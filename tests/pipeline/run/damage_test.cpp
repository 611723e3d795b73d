// Damage, end to end: whatever file of a finished run has a byte changed or is cut short, the next
// run ends in the clean bytes, or says what is wrong and ends in none.
#include <fmt/format.h>

#include <fstream>

#include "storage/support/file_io.h"
#include "tests/pipeline/run/scene.h"

namespace voxweld::testing {
namespace {

namespace fs = std::filesystem;
using Bytes = std::vector<std::byte>;

struct Damage {
  const char* name;
  void (*apply)(Bytes&, std::mt19937&);
};

void change_a_bit(Bytes& bytes, std::mt19937& random) {
  if (!bytes.empty()) bytes[random() % bytes.size()] ^= std::byte(1u << (random() % 8));
}
void cut(Bytes& bytes, std::mt19937& random) {
  bytes.resize(random() % std::max<std::size_t>(1, bytes.size()));
}
void empty(Bytes& bytes, std::mt19937&) {
  bytes.clear();
}

const Damage damages[] = {{"a bit changed", change_a_bit}, {"cut", cut}, {"empty", empty}};

void damage(const fs::path& file, const Damage& how, std::mt19937& random) {
  Bytes bytes = read_whole_file(file);
  how.apply(bytes, random);
  write_whole_file(file, bytes, Durability::rename_only);
}

// Where in a run's directories each kind of file lies, by the end of its name.
struct FileKind {
  const char* name;
  bool in_work;
  const char* ending;
};

const FileKind file_kinds[] = {{"octree", true, ".octree"},
                               {"top tree", true, "top.tree"},
                               {"tile", true, ".tile"},
                               {"asset record", true, "0.record"},
                               {"merged record", true, "merged.record"},
                               {"last config", true, "last-run.toml"},
                               {"tile drc", false, "0.drc"},
                               {"tile glb", false, "1.glb"},
                               {"merged drc", false, "mesh.drc"},
                               {"merged glb", false, "mesh.glb"},
                               {"manifest", false, "manifest.json"},
                               {"tile list", false, "tiles.jsonl"}};
const FileKind store_kinds[] = {{"shard record", true, ".shard"}, {"zarr.json", true, "zarr.json"}};

const Settings small_work = {"work.brick=16", "work.shard=2", "output.tile_vertices=1024"};

// After the damage, a run, and the same with everything after build to be done again, which reads
// what the first may have trusted.
void expect_mended(const Scene& scene, const Settings& settings, const Tree& clean) {
  for (const bool from_build : {false, true}) {
    if (from_build) scene.forget_stages({"merge", "stitch", "encode"});
    const ProgramResult result = scene.run(settings);
    VOXWELD_EXPECT_DONE(result);
    EXPECT_EQ(difference(clean, output_tree(scene.output())), "");
  }
}

template <class Kinds>
void expect_all_mended(const Scene& scene, const Settings& settings, const Kinds& all,
                       unsigned seed) {
  std::mt19937 random(seed);
  VOXWELD_EXPECT_DONE(scene.run(settings));
  const Tree clean = output_tree(scene.output());
  for (const FileKind& kind : all)
    for (const Damage& how : damages) {
      SCOPED_TRACE(fmt::format("{}: {}", kind.name, how.name));
      const auto files = files_ending(kind.in_work ? scene.work() : scene.output(), kind.ending);
      ASSERT_FALSE(files.empty());
      damage(files[random() % files.size()], how, random);
      expect_mended(scene, settings, clean);
    }
}

TEST(Damage, OfEachKindIsMended) {
  expect_all_mended(Scene("porous", 40), small_work, file_kinds, 1);
}

TEST(Damage, OfTheStoreIsMended) {
  expect_all_mended(Scene("porous", 40), small_work + Settings{"work.copy=true"}, store_kinds, 2);
}

// A shard of the store is vouched for by its record until its samples are read.
TEST(Damage, OfAStoreShardIsMendedWhenItIsRead) {
  const Scene scene("porous", 40);
  const Settings settings = small_work + Settings{"work.copy=true"};
  VOXWELD_EXPECT_DONE(scene.run(settings));
  const Tree clean = output_tree(scene.output());
  std::mt19937 random(3);
  for (const Damage& how : damages) {
    SCOPED_TRACE(how.name);
    std::vector<fs::path> shards;
    for (const fs::path& file : files_ending(scene.work(), ""))
      if (file.string().find("volume.zarr/c/") != std::string::npos) shards.push_back(file);
    ASSERT_FALSE(shards.empty());
    damage(shards[random() % shards.size()], how, random);
    scene.forget_stages({"build"});
    expect_mended(scene, settings, clean);
  }
}

// The histogram decides the isovalue where the config leaves the choice open.
TEST(Damage, OfTheHistogramIsMended) {
  expect_all_mended(Scene("part", 40), small_work + Settings{"surface.isovalue=otsu"},
                    std::vector<FileKind>{{"histogram", true, "histogram"}}, 4);
}

// The note that encode leaves while it is at work.
TEST(Damage, OfTheNoteOfAnUnfinishedOutputChangesNothing) {
  const Scene scene("porous", 32);
  VOXWELD_EXPECT_DONE(scene.run(small_work));
  const Tree clean = output_tree(scene.output());
  for (const std::string& text : {std::string(), std::string(200, 'x')}) {
    write_whole_file(scene.output() / "unfinished.files", as_bytes(text), Durability::rename_only);
    VOXWELD_EXPECT_DONE(scene.run(small_work));
    EXPECT_EQ(difference(clean, output_tree(scene.output())), "");
  }
}

// A run that writes other files clears away those of the one before, also where the list that names
// them is damaged.
TEST(Damage, OfAListOfFilesLeavesNoneBehind) {
  const Scene scene("porous", 48);
  const Settings other = small_work + Settings{"output.tile_vertices=1024", "output.merged=false"};
  VOXWELD_EXPECT_DONE(scene.run(other));
  const Tree clean = output_tree(scene.output());
  for (const auto& [list, part, changed] :
       {std::array<std::string, 3>{"manifest.json", "\"lattice\"", "\"lettice\""},
        {"manifest.json", "mesh.glb", "mesh.gmb"},
        {"tiles.jsonl", "-0.glb", "-0.gmb"},
        {"tiles.jsonl", "{", ""}}) {
    SCOPED_TRACE(list + changed);
    VOXWELD_EXPECT_DONE(scene.run(small_work));
    std::ofstream(scene.output() / "tiles" / "notes.txt") << "mine";
    std::string text = text_of_file(scene.output() / list);
    text.replace(text.find(part), part.size(), changed);
    write_whole_file(scene.output() / list, as_bytes(text), Durability::rename_only);
    VOXWELD_EXPECT_DONE(scene.run(other));
    EXPECT_TRUE(fs::remove(scene.output() / "tiles" / "notes.txt"));
    EXPECT_EQ(difference(clean, output_tree(scene.output())), "");
  }
}

// Many places of many files at once.
TEST(Damage, EverywhereIsMended) {
  const Scene scene("porous", 40);
  const Settings settings = small_work + Settings{"work.copy=true"};
  VOXWELD_EXPECT_DONE(scene.run(settings));
  const Tree clean = output_tree(scene.output());
  std::mt19937 random(5);
  for (int i = 0; i < 5; ++i) {
    for (const fs::path& root : {scene.work(), scene.output()})
      for (const fs::path& file : files_ending(root, ""))
        if (random() % 2 == 0) damage(file, damages[random() % std::size(damages)], random);
    const ProgramResult result = scene.run(settings);
    VOXWELD_EXPECT_DONE(result);
    EXPECT_EQ(difference(clean, output_tree(scene.output())), "") << result.err;
  }
}

TEST(Damage, IsNamedWhenItIsMended) {
  const Scene scene("porous", 40);
  VOXWELD_EXPECT_DONE(scene.run(small_work));
  std::mt19937 random(6);
  const fs::path octree = files_ending(scene.work(), ".octree").at(0);
  // A piece of a brick, not the summary: found when it is read again.
  Bytes bytes = read_whole_file(octree);
  bytes[1000] ^= std::byte{1};
  write_whole_file(octree, bytes, Durability::rename_only);
  const ProgramResult result = scene.run(small_work + Settings{"output.precision=0.1"});
  VOXWELD_EXPECT_DONE(result);
  expect_says(result, octree.string() + ": the checksum of a piece");
  expect_says(result, "it is removed and made again");
  EXPECT_EQ(difference(scene.clean_tree(small_work + Settings{"output.precision=0.1"}),
                       output_tree(scene.output())),
            "");
}

// A stage by itself does not mend what another made: it refuses, naming the file.
TEST(Damage, IsRefusedByASingleStage) {
  const Scene scene("porous", 40);
  VOXWELD_EXPECT_DONE(scene.run(small_work));
  const fs::path octree = files_ending(scene.work(), ".octree").at(0);
  Bytes bytes = read_whole_file(octree);
  bytes[1000] ^= std::byte{1};
  write_whole_file(octree, bytes, Durability::rename_only);
  const ProgramResult result =
      scene.command("stitch", small_work + Settings{"output.precision=0.1"});
  expect_refused(result, octree.string() + ": the checksum of a piece", 1);
}

}  // namespace
}  // namespace voxweld::testing
