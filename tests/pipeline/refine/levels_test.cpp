// Coarser levels of detail: closed at any mix, the same however the work is cut, near the mesh.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>

#include "stages/refine/coarsen.h"
#include "tests/pipeline/refine/level_mix.h"
#include "tests/pipeline/refine/refine_work.h"

namespace voxweld::testing {
namespace {

const Settings levels = {
    "simplify.refine=collapse",  "work.brick=16",           "work.shard=2",
    "output.tile_vertices=1024", "simplify.tolerance=0.05", "output.levels=\"auto\""};

class Levels : public ::testing::TestWithParam<const char*> {
 protected:
  static Scene scene() { return Scene(GetParam(), 80); }
};

TEST_P(Levels, AnyMixIsClosedAndOfOneTopology) {
  const Scene scene = Levels::scene();
  VOXWELD_EXPECT_DONE(scene.run(levels));
  EXPECT_GE(expect_good(scene.output()).levels, 2u);
  const auto all = all_meshes(scene.output());
  std::mt19937 random(5);
  std::vector<const ListedMesh*> finest;
  for (const ListedMesh& one : all)
    if (one.record.lod == 0) finest.push_back(&one);
  const auto eulers = component_eulers(welded(finest).triangles);
  std::size_t mixed = 0;
  for (int mix = 0; mix < 12; ++mix) {
    const auto shown = any_mix(all, random);
    std::set<int> lods;
    for (const ListedMesh* one : shown) lods.insert(one->record.lod);
    mixed += lods.size() > 1 ? 1 : 0;
    const WeldedMesh mesh = welded(shown);
    EXPECT_TRUE(check_edges(mesh.triangles).closed()) << mix;
    EXPECT_EQ(nonmanifold_vertices(mesh.triangles).size(), 0u) << mix;
    EXPECT_EQ(component_eulers(mesh.triangles), eulers) << mix;
  }
  EXPECT_GT(mixed, 3u);
}

TEST_P(Levels, EachHasFewerTrianglesAndKeepsItsTolerance) {
  const Scene scene = Levels::scene();
  VOXWELD_EXPECT_DONE(scene.run(levels));
  const auto listed = manifest_of(scene.output()).at("levels");
  // Four times that of the level before; eight times at the first, where there would be many triangles.
  const std::array tolerances = {0.05, 0.4, 1.6};
  ASSERT_EQ(listed.size(), tolerances.size());
  for (std::size_t level = 1; level < listed.size(); ++level) {
    const auto& one = listed[level];
    SCOPED_TRACE(one.dump());
    EXPECT_LT(one.at("triangles"), listed[level - 1].at("triangles").get<double>() * 0.8);
    EXPECT_LE(one.at("tiles"), listed[level - 1].at("tiles"));
    EXPECT_NEAR(one.at("tolerance").get<double>(), tolerances[level], 1e-9);
    // To the end of a bin, which is a quarter of an octave.
    EXPECT_LE(one.at("p99"), one.at("tolerance").get<double>() * 1.19);
    EXPECT_EQ(one.at("intersecting_left"), 0);
    EXPECT_GE(one.at("worst"), one.at("p99"));
    // It has the error of the tiles that it is made of, and its own.
    if (level > 1) {
      EXPECT_GT(one.at("worst"), listed[level - 1].at("worst"));
    }
  }
}

// Viewers show nothing of a tileset while its error takes few pixels: it has to be as large as the whole.
TEST_P(Levels, ATilesetIsShownWhileItIsLargeOnTheScreen) {
  const Scene scene = Levels::scene();
  VOXWELD_EXPECT_DONE(scene.run(levels));
  const auto tileset = nlohmann::json::parse(read_text_file(scene.output() / "tileset.json"));
  double squares = 0;
  const auto& box = tileset.at("root").at("boundingVolume").at("box");
  for (std::size_t i = 3; i < 12; ++i) squares += std::pow(box.at(i).get<double>(), 2);
  EXPECT_NEAR(tileset.at("geometricError").get<double>(), 2 * std::sqrt(squares), 1e-6);
  EXPECT_EQ(tileset.at("asset").at("extras").at("manifest"), "manifest.json");
  const std::filesystem::path made_from =
      tileset.at("asset").at("extras").at("made_from").get<std::string>();
  EXPECT_EQ(made_from.extension(), ".nrrd");
  EXPECT_FALSE(made_from.has_parent_path());
}

TEST_P(Levels, AreTheSameWhateverThePartition) {
  const Scene scene = Levels::scene();
  const Tree tree = scene.expect_one_tree(
      levels, {{"work.brick=32", "work.shard=1", "run.threads=3"},
               {"work.brick=128", "work.shard=1", "work.copy=true", "run.memory=64GiB"}});
  EXPECT_TRUE(tree.contains("tileset.json"));
  EXPECT_TRUE(tree.contains("levels.jsonl"));
}

// Points of the first coarser level for each of its vertices.
double points_per_vertex(const Scene& scene) {
  double points = 0, vertices = 0;
  for (const ListedMesh& one : all_meshes(scene.output())) {
    if (one.record.lod != 1) continue;
    points += static_cast<double>(one.mesh.positions.size());
    vertices += static_cast<double>(one.record.vertices);
  }
  return points / vertices;
}

TEST(LevelsWork, WhatIsSmoothIsShadedSo) {
  const Scene scene("gyroid", 112);
  VOXWELD_EXPECT_DONE(scene.run(levels));
  EXPECT_LT(points_per_vertex(scene), 1.6);
}

// Of all normals those that an octahedron of 8 bits has: whole numbers in units of its 127th part.
double share_of_eight_bits(const Scene& scene, int lod) {
  double all = 0, found = 0;
  for (const ListedMesh& one : all_meshes(scene.output())) {
    if (one.record.lod != lod) continue;
    for (const std::array<float, 3>& normal : one.mesh.normals) {
      const float sum = std::abs(normal[0]) + std::abs(normal[1]) + std::abs(normal[2]);
      all += 1;
      found += std::ranges::all_of(normal, [&](float x) {
        return std::abs(x / sum * 127 - std::round(x / sum * 127)) < 1e-3f;
      });
    }
  }
  EXPECT_GT(all, 0);
  return found / all;
}

TEST(LevelsWork, NormalsTakeFewerBitsThanThoseOfTheMesh) {
  const Scene scene("gyroid", 80);
  VOXWELD_EXPECT_DONE(scene.run(levels));
  EXPECT_LT(share_of_eight_bits(scene, 0), 0.5);
  EXPECT_EQ(share_of_eight_bits(scene, 1), 1);
  EXPECT_EQ(share_of_eight_bits(scene, 2), 1);
}

// Two flats meet at each of most vertices.
TEST(LevelsWork, CreasesStaySharp) {
  const Scene scene("part", 160);
  VOXWELD_EXPECT_DONE(scene.run(levels));
  EXPECT_GT(points_per_vertex(scene), 1.5);
}

TEST(LevelGrain, IsAPowerOfTwoOfATwelfthOfTheTolerance) {
  EXPECT_EQ(level_grain(0.5), 1);
  EXPECT_EQ(level_grain(12), 1);
  EXPECT_EQ(level_grain(23.9), 1);
  EXPECT_EQ(level_grain(24), 2);
  EXPECT_EQ(level_grain(52), 4);
  EXPECT_EQ(level_grain(1e6), 65536);
  EXPECT_EQ(level_grain(1e30), 1);  // everything goes
  EXPECT_EQ(level_grain(std::numeric_limits<double>::infinity()), 1);
}

INSTANTIATE_TEST_SUITE_P(Phantoms, Levels, ::testing::Values("gyroid", "porous"),
                         [](const auto& each) { return each.param; });

// Of an earlier run with other levels nothing stays behind.
TEST(LevelsWork, FollowsItsNumber) {
  const Scene scene("gyroid", 72);
  const Tree none = scene.clean_tree(levels + Settings{"output.levels=1"});
  const Tree two = scene.clean_tree(levels + Settings{"output.levels=2"});
  VOXWELD_EXPECT_DONE(scene.run(levels));
  EXPECT_GT(output_tree(scene.output()).size(), two.size());
  VOXWELD_EXPECT_DONE(scene.run(levels + Settings{"output.levels=2"}));
  EXPECT_EQ(difference(two, output_tree(scene.output())), "");
  EXPECT_EQ(units_run(scene.output()).at("encode"), 0u);  // all of it was there
  EXPECT_TRUE(std::filesystem::exists(scene.output() / "levels"));
  VOXWELD_EXPECT_DONE(scene.run(levels + Settings{"output.levels=1"}));
  EXPECT_EQ(difference(none, output_tree(scene.output())), "");
  EXPECT_FALSE(std::filesystem::exists(scene.output() / "levels")) << "an empty folder stays";
}

// One tile is all there is: coarser ones have the same cube.
TEST(LevelsWork, OfOneTile) {
  const Scene scene("gyroid", 64);
  VOXWELD_EXPECT_DONE(
      scene.run({"simplify.refine=collapse", "output.levels=3", "simplify.tolerance=0.05"}));
  EXPECT_EQ(expect_good(scene.output()).levels, 2u);
  const auto listed = manifest_of(scene.output()).at("levels");
  ASSERT_EQ(listed.size(), 3u);
  EXPECT_LT(listed[2].at("triangles"), listed[1].at("triangles"));
}

TEST(LevelsWork, BetweenLabelsAreClosed) {
  const Scene scene(volume_of({80, 76, 72}, [](Index3 at) {
    return 1 + (at.x + at.z / 3) / 23 + 10 * ((at.y + at.x / 5) / 19);
  }));
  const Settings shared = levels + Settings{"labels.mode=shared"};
  VOXWELD_EXPECT_DONE(scene.run(shared));
  EXPECT_GE(expect_good(scene.output()).levels, 1u);
  scene.expect_one_tree(shared, {{"work.brick=32", "work.shard=1"}});
}

TEST(LevelsWork, OfAnOpenBorder) {
  const Scene scene("gyroid", 72);
  VOXWELD_EXPECT_DONE(
      scene.run(levels + Settings{"surface.border=open", "input.crop=[12,9,12,60,63,57]"}));
  const VerifyReport report = expect_good(scene.output());
  EXPECT_GE(report.levels, 1u);
  EXPECT_GT(report.boundary_edges, 0u);
}

TEST(LevelsWork, StageByStageAndGoesOn) {
  const Scene scene("porous", 72);
  const Tree clean = scene.clean_tree(levels);
  for (const char* stage : {"ingest", "build", "merge", "stitch", "refine", "seams", "mend",
                            "remend", "retile", "levels", "encode"})
    VOXWELD_EXPECT_DONE(scene.command(stage, levels));
  EXPECT_EQ(difference(clean, output_tree(scene.output())), "");
  expect_goes_on(scene, levels, clean, {"levels", "retile"});
}

TEST(LevelsWork, DamageIsFoundAndMended) {
  expect_damage_is_mended(Scene("porous", 72), levels, 3,
                          {{"levels", ".cubes", "encode"}, {"levels", ".cubes", "levels"}});
}

TEST(LevelsWork, KillsLoseNothing) {
  expect_kills_lose_nothing(Scene("porous", 72), levels, 3, 0.5);
}

// A share needs what others make of the level before.
TEST(LevelsWork, AShareThatComesTooEarlySaysSo) {
  const Scene scene("gyroid", 80);
  VOXWELD_EXPECT_DONE(scene.run(levels));
  const Tree clean = output_tree(scene.output());
  scene.forget_stages({"levels"});
  const std::size_t last = manifest_of(scene.output()).at("levels").size();
  ASSERT_GE(last, 3u);
  // The root comes last.
  const auto listed = std::ranges::count(read_text_file(scene.output() / levels_name), '\n');
  expect_refused(scene.command_with("levels", levels, {"--tiles", std::to_string(listed - 1)}),
                 "run `voxweld levels CONFIG` again");
  for (const char* part : {"0/2", "1/2"}) scene.command_with("levels", levels, {"--part", part});
  VOXWELD_EXPECT_DONE(scene.run(levels));
  EXPECT_EQ(difference(clean, output_tree(scene.output())), "");
}

TEST(LevelsWork, AreRefusedWhereThereCanBeNone) {
  const Scene scene("gyroid", 48);
  expect_refused(scene.run({"simplify.refine=off", "output.levels=2"}), "set it to \"repair\"");
  expect_refused(scene.run({"simplify.refine=collapse", "output.levels=2", "output.tiles=false"}),
                 "levels of detail are tiles");
  expect_refused(scene.command("levels", {"simplify.refine=collapse"}), "no stage levels");
}

TEST(LevelsWork, AreShownAndTold) {
  const Scene scene("gyroid", 80);
  VOXWELD_EXPECT_DONE(scene.run(levels + Settings{"output.report=true"}));
  const auto listed = manifest_of(scene.output()).at("levels");
  const std::string output = scene.output().string();
  const std::string ply = (scene.directory() / "level.ply").string();
  expect_levels_are_exported(scene);
  expect_refused(run_voxweld({"render", output, "-o", ply + "2.png", "--level", "9"}),
                 fmt::format("has levels 0 to {}", listed.size() - 1));
  expect_refused(run_voxweld({"render", ply, "-o", ply + "3.png", "--level", "1"}),
                 "only output directories have levels");
  const ProgramResult info = run_voxweld({"info", output, "--check"});
  VOXWELD_EXPECT_DONE(info);
  EXPECT_NE(info.out.find("levels"), std::string::npos);
  EXPECT_NE(read_text_file(scene.output() / "report.html").find("Levels of detail"),
            std::string::npos);
}

// A coarser tolerance has nothing to do with levels, and makes none.
TEST(LevelsWork, ExtractMakesNone) {
  const Scene scene("gyroid", 72);
  VOXWELD_EXPECT_DONE(scene.run(levels));
  const std::string made = (scene.directory() / "coarse.drc").string();
  const ProgramResult extracted =
      scene.command_with("extract", levels, {"--tolerance", "0.2", "-o", made});
  VOXWELD_EXPECT_DONE(extracted);
  EXPECT_EQ(extracted.err.find("levels"), std::string::npos) << extracted.err;
  VOXWELD_EXPECT_DONE(scene.run(levels + Settings{"output.levels=1", "simplify.tolerance=0.2"}));
  EXPECT_EQ(read_whole_file(made), read_whole_file(scene.output() / "mesh.drc"));
}

// Where a tile of a level is another one, there is a crack, and verify sees it.
TEST(LevelsWork, ACrackIsFound) {
  const Scene scene("gyroid", 80);
  VOXWELD_EXPECT_DONE(
      scene.run(levels + Settings{"output.formats=[\"ply\"]", "output.merged=false"}));
  TileListReader reader(scene.output() / levels_name);
  const auto first = reader.next(), second = reader.next();
  ASSERT_TRUE(first && second);
  const auto path = scene.output() / second->files.front().path;
  std::filesystem::copy_file(scene.output() / first->files.front().path, path,
                             std::filesystem::copy_options::overwrite_existing);
  const VerifyReport report = verify_output(scene.output());
  EXPECT_FALSE(report.good());
}

}  // namespace
}  // namespace voxweld::testing
