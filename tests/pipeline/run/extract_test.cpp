// Coarser meshes from what a run has left: voxweld extract, and runs of a larger tolerance.
#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <set>

#include "pipeline/output/load.h"
#include "tests/pipeline/run/edit_scene.h"
#include "tests/pipeline/run/label_volumes.h"
#include "tests/pipeline/run/scene.h"

namespace voxweld::testing {
namespace {

namespace fs = std::filesystem;

const Settings fine = {"simplify.tolerance=0.05"};
const Settings many_shards = {"work.brick=16", "work.shard=2", "output.tile_vertices=1024"};

// Plates at an angle, thin ones too, and a ball.
RawVolume plates(Index3 size) {
  return volume_of(size, [size](Index3 p) {
    const auto plate = [&](std::int64_t at, std::int64_t half) {
      return half - std::abs(17 * p.z + 4 * p.x - 3 * p.y - at);
    };
    const std::int64_t edge = 8 * std::min({p.x - 3, p.y - 3, p.z - 2, size.x - 4 - p.x,
                                            size.y - 4 - p.y, size.z - 3 - p.z});
    const Index3 d = p - Index3{24, 25, 20};
    const std::int64_t ball = 140 - (d.x * d.x + d.y * d.y + d.z * d.z);
    return std::clamp<std::int64_t>(
        128 + std::min(edge, std::max({plate(300, 11), plate(520, 60), ball})), 0, 255);
  });
}

Settings with(const Settings& settings, double tolerance) {
  return settings + Settings{fmt::format("simplify.tolerance={}", tolerance)};
}
ProgramResult extract(const Scene& scene, const Settings& settings, double tolerance,
                      const fs::path& output, const Arguments& options = {}) {
  return scene.command_with(
      "extract", settings,
      Arguments{"--tolerance", fmt::format("{}", tolerance), "-o", output.string()} + options);
}
std::vector<fs::path> files_of(const fs::path& folder) {
  return files_ending(folder, "");
}

// At each tolerance what a run of it leaves, from one run; and nothing else.
void expect_cuts(const Scene& scene, const Settings& settings,
                 const std::vector<double>& tolerances) {
  VOXWELD_EXPECT_DONE(scene.run(settings));
  const auto before = files_of(scene.work());
  for (const double tolerance : tolerances) {
    const fs::path cut = scene.directory() / "cut.mesh";
    fs::remove_all(cut);
    const ProgramResult result = extract(scene, settings, tolerance, cut);
    VOXWELD_EXPECT_DONE(result);
    EXPECT_EQ(files_of(scene.work()), before);
    scene.forget("alone");
    VOXWELD_EXPECT_DONE(scene.run_in("alone", with(settings, tolerance)));
    EXPECT_EQ(difference(output_tree(scene.output("alone")), output_tree(cut)), "") << tolerance;
    expect_good(cut);
  }
}

TEST(Extract, IsARunAtAnyLargerTolerance) {
  const Scene scene(plates({61, 58, 50}));
  expect_cuts(scene, fine + many_shards, {0.05, 0.07, 0.1, 0.2, 0.35, 0.8, 2, 1000});
}

TEST(Extract, IsRefinedAsARunIs) {
  const Scene scene(plates({61, 58, 50}));
  expect_cuts(scene, fine + many_shards + Settings{"simplify.refine=collapse"}, {0.1, 0.6});
  expect_cuts(scene, fine + Settings{"simplify.refine=collapse", "simplify.triangles=400"}, {0.2});
}

TEST(Extract, DoesSoForEachLabelAndForOne) {
  const Scene scene(cell_labels({50, 40, 36}, 5, 0.01, 3));
  expect_cuts(scene, fine + many_shards + Settings{"labels.mode=each"}, {0.2, 0.9});
  expect_cuts(scene, fine + many_shards + Settings{"labels.mode=each", "simplify.refine=collapse"},
              {0.5});
  expect_cuts(scene, fine + Settings{"surface.label=2", "surface.isovalue=2"}, {0.5});
}

TEST(Extract, TakesEditsAsTheyAre) {
  const Scene scene(plates({61, 58, 50}));
  const EditScene edits(scene);
  edits.set(testing::ball("subtract", {30, 30, 25}, 11));
  expect_cuts(scene, fine + many_shards, {0.3});
  // One more edit: the octrees are out of date.
  edits.set(testing::ball("subtract", {30, 30, 25}, 11) + testing::ball("add", {10, 10, 10}, 7));
  const fs::path cut = scene.directory() / "cut.mesh";
  fs::remove_all(cut);
  expect_refused(extract(scene, fine + many_shards, 0.3, cut), "missing or out of date");
}

// The copy of the samples is no more what it was, which nobody sees who does not read it.
TEST(Extract, ReadsNoSamples) {
  const Scene scene(plates({61, 58, 50}));
  const Settings copied = fine + many_shards + Settings{"work.copy=true", "work.chunk=16"};
  const fs::path whole = scene.directory() / "whole.drc", cut = scene.directory() / "cut.drc";
  VOXWELD_EXPECT_DONE(scene.run(copied));
  VOXWELD_EXPECT_DONE(extract(scene, copied, 0.4, whole));
  std::size_t spoiled = 0;
  for (const auto& file : files_ending(scene.work(), "")) {
    if (file.string().find("volume.zarr/c") == std::string::npos) continue;
    std::fstream(file, std::ios::in | std::ios::out | std::ios::binary)
        .write("no sample of this volume", 24);
    ++spoiled;
  }
  EXPECT_GT(spoiled, 4u);
  const ProgramResult result = extract(scene, copied, 0.4, cut);
  VOXWELD_EXPECT_DONE(result);
  EXPECT_NE(result.out.find("bricks cut, "), std::string::npos) << result.out;
  EXPECT_EQ(text_of_file(cut), text_of_file(whole));
}

TEST(Extract, WritesOneFile) {
  const Scene scene(plates({61, 58, 50}));
  VOXWELD_EXPECT_DONE(scene.run(fine));
  VOXWELD_EXPECT_DONE(scene.run_in("alone", with(fine, 0.3)));
  const auto before = files_of(scene.work());
  for (const char* name : {"cut.drc", "cut.glb"}) {
    VOXWELD_EXPECT_DONE(extract(scene, fine, 0.3, scene.directory() / name));
    EXPECT_EQ(text_of_file(scene.directory() / name),
              text_of_file(scene.output("alone") / ("mesh" + fs::path(name).extension().string())));
  }
  // A format that runs do not write is converted to.
  VOXWELD_EXPECT_DONE(extract(scene, fine, 0.3, scene.directory() / "cut.off"));
  VOXWELD_EXPECT_DONE(run_voxweld({"export", (scene.output("alone") / "mesh.drc").string(), "-o",
                                   (scene.directory() / "other.off").string()}));
  EXPECT_EQ(text_of_file(scene.directory() / "cut.off"),
            text_of_file(scene.directory() / "other.off"));
  VOXWELD_EXPECT_DONE(extract(scene, fine, 0.3, scene.directory() / "cut.ply"));
  Settings ply = with(fine, 0.3);
  ply.emplace_back("output.formats=[\"ply\"]");
  VOXWELD_EXPECT_DONE(scene.run_in("ply", ply));
  EXPECT_EQ(text_of_file(scene.directory() / "cut.ply"),
            text_of_file(scene.output("ply") / "mesh.ply"));
  EXPECT_EQ(files_of(scene.work()), before);
  expect_refused(extract(scene, fine, 0.3, scene.directory() / "cut.ply"), "exists already");
  VOXWELD_EXPECT_DONE(extract(scene, fine, 0.5, scene.directory() / "cut.ply", {"--force"}));
}

using Place = std::array<float, 3>;

// Of the triangles that reach into the box, each from its least corner on.
std::multiset<std::array<Place, 3>> corners_of(const DecodedMesh& mesh, const Place& lo,
                                               const Place& hi) {
  std::multiset<std::array<Place, 3>> found;
  for (const auto& t : mesh.triangles) {
    std::array<Place, 3> c{mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]};
    bool reaches = true;
    for (std::size_t a = 0; a < 3; ++a)
      reaches = reaches && std::max({c[0][a], c[1][a], c[2][a]}) >= lo[a] &&
                std::min({c[0][a], c[1][a], c[2][a]}) <= hi[a];
    std::rotate(c.begin(), std::min_element(c.begin(), c.end()), c.end());
    if (reaches) found.insert(c);
  }
  return found;
}

TEST(Extract, LeavesOutWhatDoesNotReachIntoABox) {
  const Scene scene(plates({61, 58, 50}));
  VOXWELD_EXPECT_DONE(scene.run(fine + many_shards));
  const fs::path whole = scene.directory() / "whole.drc", part = scene.directory() / "part.drc";
  VOXWELD_EXPECT_DONE(extract(scene, fine + many_shards, 0.2, whole));
  VOXWELD_EXPECT_DONE(
      extract(scene, fine + many_shards, 0.2, part, {"--box", "10,12,9,31.5,33,27"}));
  const Place lo{10, 12, 9}, hi{31.5F, 33, 27}, far_lo{-99, -99, -99}, far_hi{999, 999, 999};
  const auto expected = corners_of(load_mesh(whole), lo, hi);
  EXPECT_GT(expected.size(), 100u);
  EXPECT_LT(expected.size() * 2, load_mesh(whole).triangles.size());
  EXPECT_EQ(corners_of(load_mesh(part), far_lo, far_hi), expected);
  const fs::path other = scene.directory() / "other.drc";
  expect_refused(extract(scene, fine + many_shards, 0.2, other, {"--box", "900,0,0,910,9,9"}),
                 "no triangle of the mesh reaches into the box");
  expect_refused(extract(scene, fine + many_shards, 0.2, other, {"--box", "5,0,0,4,9,9"}),
                 "x0 <= x1");
  expect_refused(extract(scene, fine + many_shards, 0.2, scene.directory() / "box.mesh",
                         {"--box", "0,0,0,4,9,9"}),
                 "give -o the name of a file");
}

TEST(Extract, RefusesWhatItCannotCut) {
  const Scene scene(plates({40, 40, 40}));
  const fs::path cut = scene.directory() / "cut.drc";
  expect_refused(extract(scene, fine, 0.2, cut), "run `voxweld run CONFIG` first");
  VOXWELD_EXPECT_DONE(scene.run(fine));
  expect_refused(extract(scene, fine, 0.01, cut), "give 0.05 or more");
  expect_refused(extract(scene, fine, 0.2, scene.directory() / "cut.txt"),
                 "expected a mesh file, .drc, .glb, .plain.glb, .meshopt.glb, .ply");
  expect_refused(extract(scene, fine + Settings{"simplify.topology=safe"}, 0.2, cut),
                 "voxweld run CONFIG --set simplify.tolerance=0.2");
  EXPECT_FALSE(fs::exists(cut));
}

// What is damaged is made anew from samples, and the mesh is the same.
TEST(Extract, MendsDamagedOctrees) {
  const Scene scene(plates({61, 58, 50}));
  VOXWELD_EXPECT_DONE(scene.run(fine + many_shards));
  const fs::path whole = scene.directory() / "whole.drc", cut = scene.directory() / "cut.drc";
  VOXWELD_EXPECT_DONE(extract(scene, fine + many_shards, 0.2, whole));
  const fs::path octree = files_ending(scene.work(), ".octree").front();
  std::fstream file(octree, std::ios::in | std::ios::out | std::ios::binary);
  file.seekp(400);
  file.put('\x55').put('\x55').put('\x55');
  file.close();
  const ProgramResult result = extract(scene, fine + many_shards, 0.2, cut);
  VOXWELD_EXPECT_DONE(result);
  expect_says(result, "made again");
  EXPECT_EQ(text_of_file(cut), text_of_file(whole));
}

// Runs of larger tolerances, one after the other in the same work folder: the octrees that are there
// are cut, and what comes out is that of a run by itself.
void expect_runs_cut(const Scene& scene, const Settings& settings,
                     const std::vector<double>& tolerances) {
  VOXWELD_EXPECT_DONE(scene.run(settings));
  for (const double tolerance : tolerances) {
    const ProgramResult again = scene.run(with(settings, tolerance));
    VOXWELD_EXPECT_DONE(again);
    expect_says(again, "bricks 0 were built");
    expect_says(again, "read in place of samples");
    EXPECT_EQ(difference(scene.clean_tree(with(settings, tolerance)), output_tree(scene.output())),
              "")
        << tolerance;
  }
}

TEST(CoarserRun, CutsTheOctreesThatAreThere) {
  const Scene scene(plates({61, 58, 50}));
  // At last one that lies between two of those.
  expect_runs_cut(scene, fine + many_shards, {0.1, 0.8, 0.3});
  const Scene labels(cell_labels({50, 40, 36}, 5, 0.01, 3));
  expect_runs_cut(labels, fine + many_shards + Settings{"labels.mode=each"}, {0.4});
}

// Of a finer one, of another surface, and where octrees keep no levels.
TEST(CoarserRun, ReadsSamplesWhereNothingFits) {
  const Scene scene(plates({61, 58, 50}));
  VOXWELD_EXPECT_DONE(scene.run(with(fine, 0.2)));
  for (const Settings& other : {with(fine, 0.1), with(fine, 0.3) + Settings{"surface.isovalue=120"},
                                with(fine, 0.3) + Settings{"simplify.topology=safe"}}) {
    const ProgramResult result = scene.run(other);
    VOXWELD_EXPECT_DONE(result);
    EXPECT_EQ(result.err.find("read in place of samples"), std::string::npos) << result.err;
    EXPECT_EQ(difference(scene.clean_tree(other), output_tree(scene.output())), "");
  }
}

TEST(CoarserRun, ReadsSamplesOfShardsWhoseOctreesAreNoMore) {
  const Scene scene(plates({61, 58, 50}));
  const Settings settings = fine + many_shards, coarse = with(settings, 0.2);
  const Tree expected = scene.clean_tree(coarse);
  VOXWELD_EXPECT_DONE(scene.run(settings));
  const auto octrees = files_ending(scene.work(), ".octree");
  ASSERT_GT(octrees.size(), 2u);
  fs::remove(octrees.front());
  std::fstream(octrees.back(), std::ios::in | std::ios::out | std::ios::binary)
      .seekp(400)
      .write("damaged", 7);
  const ProgramResult result = scene.run(coarse);
  VOXWELD_EXPECT_DONE(result);
  expect_says(result, "read in place of samples");
  EXPECT_EQ(result.err.find("bricks 0 were built"), std::string::npos) << result.err;
  EXPECT_EQ(difference(expected, output_tree(scene.output())), "");
}

TEST(CoarserRun, DoesNotNeedTheNotes) {
  const Scene scene(plates({61, 58, 50}));
  const Tree expected = scene.clean_tree(with(fine, 0.2));
  for (const char* text : {"", "much", "nan", "-1", "0.04999"}) {
    scene.forget();
    VOXWELD_EXPECT_DONE(scene.run(fine));
    const auto notes = files_ending(scene.work(), "tolerance");
    ASSERT_EQ(notes.size(), 1u);
    std::ofstream(notes.front()) << text;
    VOXWELD_EXPECT_DONE(scene.run(with(fine, 0.2)));
    EXPECT_EQ(difference(expected, output_tree(scene.output())), "") << text;
  }
}

}  // namespace
}  // namespace voxweld::testing
