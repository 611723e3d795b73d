// [[edit]] tables, end to end: what comes out, and how little is done again.
#include <fmt/format.h>

#include <fstream>
#include <numbers>

#include "pipeline/output/load.h"
#include "tests/pipeline/run/edit_scene.h"

namespace voxweld::testing {
namespace {

std::string block(const std::string& op, Vec3 center, Vec3 size, const std::string& more = "") {
  return fmt::format(
      "[[edit]]\nop = \"{}\"\nshape = \"box\"\ncenter = [{}, {}, {}]\nsize = [{}, {}, {}]\n{}\n",
      op, center.x, center.y, center.z, size.x, size.y, size.z, more);
}

double volume_after(const Scene& scene, const Settings& settings = {}) {
  VOXWELD_EXPECT_DONE(scene.run(settings));
  expect_good(scene.output());
  return enclosed_volume(load_mesh(scene.output() / "mesh.drc"));
}

const Settings small_parts = {"work.brick=16", "work.shard=2", "output.tile_vertices=1024"};

// Against exact values; the mesh's own error is of second order in the cell.
TEST(Edit, VolumesAreThoseOfTheSolids) {
  const Scene scene(noise_volume({2, 2, 2}, 1));
  const EditScene space(scene, splat(100));
  const Settings fine = {"simplify.tolerance=0.02"};
  const double r = 30, pi = std::numbers::pi, whole = 4.0 / 3 * pi * r * r * r;
  // Two balls a distance d apart share two caps of height r - d / 2.
  const double d = 25, h = r - d / 2, lens = 2 * pi * h * h * (3 * r - h) / 3;
  const Vec3 a{37.3, 50.2, 49.6}, b{37.3 + d, 50.2, 49.6};
  space.set(ball("add", a, r));
  EXPECT_NEAR(volume_after(scene, fine), whole, 5e-4 * whole);
  space.set(ball("add", a, r) + ball("add", b, r));
  EXPECT_NEAR(volume_after(scene, fine), 2 * whole - lens, 5e-4 * whole);
  space.set(ball("add", a, r) + ball("subtract", b, r));
  // Where the edge is acute its tip passes between the lattice points here and there.
  EXPECT_NEAR(volume_after(scene, fine), whole - lens, 1e-3 * whole);
  space.set(ball("add", a, r) + ball("intersect", b, r));
  EXPECT_NEAR(volume_after(scene, fine), lens, 5e-4 * whole);
}

// Flat faces and sharp edges, wherever they lie in the cells: exact but for the output's lattice.
TEST(Edit, BoxesAreExact) {
  const Scene scene(noise_volume({2, 2, 2}, 1));
  const EditScene space(scene, splat(64));
  space.set(block("add", {31.3, 30.4, 32.7}, {40.5, 30.25, 20.125}));
  EXPECT_NEAR(volume_after(scene, {"output.precision=0.001"}), 40.5 * 30.25 * 20.125, 1);
  space.set(block("add", {31.3, 30.4, 32.7}, {40, 30, 20}, "rotate = [10, 20, 30]"));
  EXPECT_NEAR(volume_after(scene, {"output.precision=0.001"}), 40.0 * 30 * 20, 5);
  space.set(block("add", {31.3, 30.4, 32.7}, {40, 40, 40}) +
            block("subtract", {31.3, 30.4, 52.7}, {20, 20, 20}));
  EXPECT_NEAR(volume_after(scene, {"output.precision=0.001"}), 64000.0 - 4000, 5);
  // A vertex on each of the sharp corners.
  const DecodedMesh mesh = load_mesh(scene.output() / "mesh.drc");
  for (const double x : {11.3, 51.3})
    for (const double y : {10.4, 50.4})
      for (const double z : {12.7, 52.7}) {
        double nearest = 1e9;
        for (const auto& p : mesh.positions) {
          const Vec3 off = Vec3{p[0], p[1], p[2]} - Vec3{x, y, z};
          nearest = std::min(nearest, std::sqrt(dot(off, off)));
        }
        EXPECT_LT(nearest, 0.01) << x << " " << y << " " << z;
      }
}

const std::string mixed = ball("subtract", {20.2, 30.1, 25.7}, 14.3) +
                          block("add", {40, 20, 40}, {15, 18, 12}, "rotate = [33, 0, 12]") +
                          "[[edit]]\nop = \"intersect\"\nshape = \"plane\"\n"
                          "center = [30, 30, 51.5]\naxis = [0.1, 0, 1]\n";

TEST(Edit, EveryPartitionGivesTheSameBytes) {
  const Scene scene("part", 64);
  const EditScene edits(scene);
  edits.set(mixed);
  scene.expect_one_tree(
      {"output.tile_vertices=1024"},
      {Settings{"work.brick=16", "work.shard=1", "work.chunk=16"},
       Settings{"work.brick=16", "work.shard=4"},
       Settings{"work.brick=32", "work.shard=2", "work.copy=true"},
       Settings{"work.brick=128", "work.shard=1", "run.threads=1", "run.memory=64GiB"}});
}

TEST(Edit, ComesChangesAndGoesAsIfItHadBeenThereFromTheStart) {
  const Scene scene("part", 64);
  const EditScene edits(scene);
  edits.set("");
  VOXWELD_EXPECT_DONE(scene.run(small_parts));
  const Tree before = output_tree(scene.output());
  for (const std::string& text : {ball("subtract", {20, 20, 20}, 9.5), mixed, mixed + mixed,
                                  ball("subtract", {20, 20, 20}, 8.5), std::string()}) {
    edits.set(text);
    VOXWELD_EXPECT_DONE(scene.run(small_parts));
    EXPECT_EQ(difference(output_tree(scene.output()), scene.clean_tree(small_parts)), "") << text;
  }
  EXPECT_EQ(difference(before, output_tree(scene.output())), "");
}

// 5 x 5 x 5 shards of 32 cells, the last layer on each axis of the ring's alone.
TEST(Edit, OnlyTheShardsItReachesAreDoneAgain) {
  const Scene scene("gyroid", 128);
  const EditScene edits(scene);
  VOXWELD_EXPECT_DONE(scene.run(small_parts));
  const auto all = units_run(scene.output());
  edits.set(ball("subtract", {48, 48, 48}, 10));  // inside one shard: samples 31 to 62
  VOXWELD_EXPECT_DONE(scene.run(small_parts));
  auto units = units_run(scene.output());
  EXPECT_EQ(units["build"], 1u);
  EXPECT_LT(units["stitch"], all.at("stitch") / 2);
  edits.set(ball("subtract", {64, 64, 64}, 10));  // where eight meet, beside the one of before
  VOXWELD_EXPECT_DONE(scene.run(small_parts));
  EXPECT_EQ(units_run(scene.output())["build"], 8u);
  VOXWELD_EXPECT_DONE(scene.run(small_parts));
  EXPECT_EQ(units_run(scene.output())["build"], 0u);
}

TEST(Edit, OfEverythingLeavesNoSurface) {
  const Scene scene("part", 32);
  const EditScene edits(scene);
  edits.set(ball("subtract", {16, 16, 16}, 60));
  const ProgramResult result = scene.run();
  expect_refused(result, "edit");
}

TEST(Edit, EmptySpaceNeedsASizeAndEdits) {
  const Scene scene(noise_volume({2, 2, 2}, 1));
  const auto refused = [&](const std::string& config, const std::string& word) {
    std::ofstream(scene.config()) << config;
    const ProgramResult result = scene.run();
    expect_refused(result, word);
  };
  const std::string edit = ball("add", {5, 5, 5}, 3);
  refused("[input]\nformat = \"empty\"\n" + edit, "input.size");
  refused("[input]\nformat = \"empty\"\nsize = [9, 9, 9]\n", "[[edit]]");
  refused("[input]\nformat = \"empty\"\nsize = [9, 9, 9]\npath = \"a.nrrd\"\n" + edit,
          "input.path");
}

}  // namespace
}  // namespace voxweld::testing
