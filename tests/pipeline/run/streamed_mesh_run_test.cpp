// Meshes as the input that do not fit run.memory, end to end: the same bytes as in memory, whatever
// happens on the way.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <csignal>
#include <fstream>

#include "storage/support/file_io.h"
#include "tests/pipeline/run/mesh_scene.h"
#include "tests/pipeline/solids/mesh_formats.h"
#include "tests/support/triangle_meshes.h"

namespace voxweld::testing {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::Not;

const Settings much_memory = {"run.memory=2GiB"};
const Settings little_memory = {"run.memory=64MiB"};
const std::string by_pieces = "the mesh does not fit run.memory; it is read by pieces";
const std::string small_tiles = "[work]\nbrick = 16\nshard = 2\n[output]\ntile_vertices = 1024\n";

// Large enough as a file; written once.
const TriangleMesh& large_ball() {
  static const TriangleMesh ball = dented_ball({3, -2, 1}, 10, 8);
  return ball;
}

// By itself a program with sanitizers takes more than these budgets; what reads, cuts up and
// answers for meshes by pieces is run under them by StreamedMesh.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool program_fits = false;
#else
constexpr bool program_fits = true;
#endif

class StreamedMeshRun : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!program_fits) GTEST_SKIP() << "run.memory is less than the sanitizers take";
  }
  void set(const std::string& name, const std::string& more = {}) const {
    if (!fs::exists(space_.at(name))) write_mesh(space_.at(name), large_ball());
    space_.set(space_.at(name), "resolution = 70", small_tiles + more);
  }
  const Scene& scene() const { return space_.scene(); }
  ProgramResult command(const std::string& name, const Settings& settings,
                        const std::vector<std::string>& more = {}) const {
    return scene().command_with(name, settings, more);
  }
  fs::path a_bin() const {
    const auto bins = files_ending(scene().work(), ".bins");
    EXPECT_GT(bins.size(), 10U);
    return bins.at(bins.size() / 2);
  }
  MeshInputScene space_;
};

TEST_F(StreamedMeshRun, TheSameBytesAsInMemory) {
  for (const char* name : {"a.off", "binary.stl", "little.ply"}) {
    set(name);
    const Tree expected = scene().clean_tree(much_memory);
    EXPECT_EQ(difference(expected, scene().clean_tree(little_memory)), "") << name;
    EXPECT_THAT(scene().run(little_memory).err, HasSubstr(by_pieces)) << name;
    EXPECT_EQ(difference(expected, output_tree(scene().output())), "") << name;
    if (std::string(name) != "a.off") continue;
    for (const char* shard : {"work.shard=1", "work.shard=4"})
      EXPECT_EQ(difference(expected,
                           scene().clean_tree(little_memory + Settings{"work.chunk=16", shard})),
                "");
  }
}

TEST_F(StreamedMeshRun, WithEditsBehindIt) {
  const auto pin = space_.at("pin.off");
  write_off(pin, box_mesh({2, -30, 0}, {4.5, 30, 2}));
  set("a.off", fmt::format("[[edit]]\nop = \"subtract\"\nshape = \"mesh\"\npath = '{}'\n"
                           "[[edit]]\nop = \"add\"\nshape = \"sphere\"\ncenter = [3, -2, 10]\n"
                           "radius = 3\n[[edit]]\nop = \"intersect\"\nshape = \"plane\"\n"
                           "center = [8, 0, 0]\naxis = [1, 0.2, 0]\n",
                           pin.string()));
  EXPECT_EQ(difference(scene().clean_tree(much_memory), scene().clean_tree(little_memory)), "");
}

TEST_F(StreamedMeshRun, MemoryDecidesNothingElse) {
  set("a.off");
  VOXWELD_EXPECT_DONE(scene().run(much_memory));
  const Tree expected = output_tree(scene().output());
  VOXWELD_EXPECT_DONE(scene().run(little_memory));
  auto units = units_run(scene().output());
  EXPECT_EQ(units["ingest"], 1U);
  EXPECT_EQ(units["build"] + units["check"] + units["stitch"] + units["encode"], 0U);
  EXPECT_EQ(difference(expected, output_tree(scene().output())), "");
}

// One command a stage: the mesh is read by the first and never again.
TEST_F(StreamedMeshRun, SingleStagesReadItOnce) {
  set("a.off");
  const Tree expected = scene().clean_tree(much_memory);
  EXPECT_THAT(command("plan", little_memory).out, HasSubstr("Estimated from the size alone"));
  EXPECT_THAT(command("build", little_memory).err,
              HasSubstr("stage build needs what stage ingest"));
  const ProgramResult ingest = command("ingest", little_memory);
  VOXWELD_EXPECT_DONE(ingest);
  EXPECT_THAT(ingest.err, Not(HasSubstr(by_pieces)));  // plan has read it
  EXPECT_THAT(command("plan", little_memory).out, HasSubstr("bricks ("));
  const auto expect_unread = [](const ProgramResult& result) {
    VOXWELD_EXPECT_DONE(result);
    EXPECT_THAT(result.err, Not(HasSubstr(by_pieces)));
  };
  for (const char* part : {"1/3", "0/3", "2/3"})
    expect_unread(command("build", little_memory, {"--part", part}));
  for (const char* stage : {"merge", "stitch", "encode"})
    expect_unread(command(stage, little_memory));
  EXPECT_EQ(difference(expected, output_tree(scene().output())), "");
  EXPECT_THAT(command("run", little_memory, {"--dry-run"}).out, HasSubstr("ingest  up to date"));
  // Touched, it is read again.
  fs::last_write_time(space_.at("a.off"), fs::file_time_type::clock::now());
  EXPECT_THAT(command("plan", little_memory).err, HasSubstr(by_pieces));
}

TEST_F(StreamedMeshRun, AsATaskOfOneUnit) {
  set("a.off");
  VOXWELD_EXPECT_DONE(command("ingest", little_memory, {"--shards", "0"}));
  VOXWELD_EXPECT_DONE(command("build", little_memory, {"--shards", "0-3"}));
  EXPECT_THAT(command("ingest", little_memory, {"--shards", "1"}).err,
              HasSubstr("--shards names 1, but stage ingest has 1 of them"));
}

TEST_F(StreamedMeshRun, KilledAtAnyInstant) {
  set("a.off");
  const Tree expected = scene().clean_tree(much_memory);
  const ProgramResult whole = scene().run_in("timing", little_memory);
  VOXWELD_EXPECT_DONE(whole);
  std::mt19937 random(6);
  std::uniform_real_distribution<double> moment(0, whole.seconds);
  for (int i = 0; i < 6; ++i) scene().run(little_memory, Stop{SIGKILL, moment(random)});
  VOXWELD_EXPECT_DONE(scene().run(little_memory));
  EXPECT_EQ(difference(expected, output_tree(scene().output())), "");
  EXPECT_TRUE(temporary_files(scene().work()).empty());
}

TEST_F(StreamedMeshRun, DamageIsFoundNamedAndMended) {
  set("a.off");
  VOXWELD_EXPECT_DONE(scene().run(little_memory));
  const Tree expected = output_tree(scene().output());
  std::mt19937 random(8);
  for (int round = 0; round < 6; ++round) {
    const fs::path path = round == 4   ? files_ending(scene().work(), "table").at(0)
                          : round == 5 ? files_ending(scene().work(), "mesh").at(0)
                                       : a_bin();
    std::vector<std::byte> bytes = read_whole_file(path);
    if (round == 1)
      bytes.resize(bytes.size() / 2);
    else
      bytes[round == 2 ? 20 : random() % bytes.size()] ^= std::byte{4};
    write_whole_file(path, bytes, Durability::rename_only);
    for (const auto& entry : fs::directory_iterator(scene().work()))
      if (!entry.path().filename().string().starts_with("ingest-")) fs::remove_all(entry.path());
    if (round == 0) {
      const ProgramResult build = command("build", little_memory);
      EXPECT_EQ(build.exit_code, 1);
      EXPECT_THAT(build.err, HasSubstr(path.string()));
    }
    const ProgramResult result = scene().run(little_memory);
    VOXWELD_EXPECT_DONE(result);
    if (round == 0) {
      EXPECT_THAT(result.err, HasSubstr("it is removed and made again"));
    }
    EXPECT_EQ(difference(expected, output_tree(scene().output())), "") << round;
  }
}

TEST_F(StreamedMeshRun, Refusals) {
  TriangleMesh open = large_ball();
  open.triangles.pop_back();
  write_mesh(space_.at("open.off"), open);
  set("open.off");
  const ProgramResult refused = scene().run(little_memory);
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(
      refused.err,
      HasSubstr("open.off: the mesh is not closed, so it has no inside: 3 of its edges have "
                "an odd number of triangles, in 1 hole ("));
  const ProgramResult wound = scene().run(little_memory + Settings{"input.close=winding"});
  expect_refused(wound, "run.memory = 64MiB is not enough for this mesh of");
  EXPECT_THAT(wound.err, HasSubstr("winding numbers (close = \"winding\") are of all its"));
}

}  // namespace
}  // namespace voxweld::testing
