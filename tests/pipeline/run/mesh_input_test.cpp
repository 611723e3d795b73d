// Meshes as the input, end to end: where the output lies, what notices a change, what is refused.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <fstream>
#include <numbers>

#include "stages/solids/mesh_boundary.h"
#include "storage/meshes/mesh_file.h"
#include "tests/pipeline/run/mesh_scene.h"
#include "tests/support/triangle_meshes.h"

namespace voxweld::testing {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

void expect_extent(const TriangleMesh& mesh, Vec3 lo, Vec3 hi, double within) {
  const Bounds extent = bounds_of(mesh);
  for (int a = 0; a < 3; ++a) {
    EXPECT_NEAR(extent.lo[a], lo[a], within);
    EXPECT_NEAR(extent.hi[a], hi[a], within);
  }
}

TriangleMesh moved_mesh(TriangleMesh mesh, Vec3 by) {
  for (Vec3& v : mesh.vertices) v = v + by;
  return mesh;
}

// Boxes come out to the output's own rounding, wherever they lie.
TEST(MeshInput, LiesInTheMeshsOwnCoordinates) {
  const MeshInputScene space;
  const Vec3 lo{-7.3, 90.25, 3}, hi{2.7, 97.25, 11.1};
  write_off(space.at("box.off"), box_mesh(lo, hi));
  for (const std::string fineness : {"resolution = 40", "cell = 0.25", "cell = 0.3\nmargin = 5"}) {
    space.set(space.at("box.off"), fineness);
    const TriangleMesh result = space.result();
    expect_good(space.scene().output());
    expect_extent(result, lo, hi, 0.003);
    EXPECT_NEAR(volume_of(result), 10 * 7 * 8.1, 0.3);
  }
  const auto frame = manifest_of(space.scene().output()).at("frame");
  EXPECT_EQ(frame.at("origin"), (nlohmann::json{0, 0, 0}));
  EXPECT_LT(frame.at("first").at(0).get<double>(), lo.x - 1.5);
  const TriangleMesh glb = welded_mesh(space.scene().output() / "mesh.glb");
  expect_extent(glb, lo, hi, 0.003);
}

// The same as empty space of the same lattice with the mesh added, less the place of sample 0.
TEST(MeshInput, IsTheMeshAddedToEmptySpace) {
  const MeshInputScene space;
  const TriangleMesh mesh = dented_ball({100, -3, 7}, 20, 5);
  write_off(space.at("a.off"), mesh);
  space.set(space.at("a.off"), "cell = 0.75");
  const TriangleMesh result = space.result();
  const auto frame = manifest_of(space.scene().output()).at("frame");
  const auto& first = frame.at("first");
  std::ofstream(space.scene().config()) << fmt::format(
      "[input]\nformat = \"empty\"\nsize = {}\nspacing = 0.75\n[simplify]\nrefine = "
      "\"off\"\n[[edit]]\nop = \"add\"\n"
      "shape = \"mesh\"\npath = '{}'\ncenter = [{}, {}, {}]\n",
      frame.at("size").dump(), space.at("a.off").string(), -first.at(0).get<double>(),
      -first.at(1).get<double>(), -first.at(2).get<double>());
  const TriangleMesh expected = moved_mesh(
      space.result(), {first.at(0).get<double>(), first.at(1).get<double>(), first.at(2)});
  EXPECT_EQ(result.vertices, expected.vertices);
  EXPECT_EQ(result.triangles, expected.triangles);
}

TEST(MeshInput, EditsAreInItsCoordinates) {
  const MeshInputScene space;
  const Vec3 lo{100, 200, -300}, hi{110, 208, -294};
  write_off(space.at("box.off"), box_mesh(lo, hi));
  write_off(space.at("other.off"), box_mesh({104, 203, -310}, {106, 205, -280}));
  const double all = 10 * 8 * 6;
  const auto volume_with = [&](const std::string& edit, const std::string& input = {}) {
    space.set(space.at("box.off"), "cell = 0.2\n" + input, "[[edit]]\n" + edit);
    const double volume = volume_of(space.result());
    expect_good(space.scene().output());
    return volume;
  };
  EXPECT_NEAR(volume_with("op = \"subtract\"\nshape = \"box\"\ncenter = [110, 208, -294]\n"
                          "size = [4.1, 2.1, 6.1]\n"),
              all - 2.05 * 1.05 * 3.05, 0.3);
  EXPECT_NEAR(volume_with("op = \"subtract\"\nshape = \"mesh\"\npath = 'other.off'\n"),
              all - 2 * 2 * 6, 0.3);
  EXPECT_NEAR(volume_with("op = \"intersect\"\nshape = \"plane\"\ncenter = [103, 0, 0]\n"
                          "axis = [1, 0, 0]\n"),
              3 * 8 * 6, 0.3);
  // What is added needs room.
  const std::string pin =
      "op = \"add\"\nshape = \"box\"\ncenter = [105, 204, -294]\nsize = [2, 2, 8]\n";
  EXPECT_LT(volume_with(pin), all + 2 * 2 * 1);
  const ProgramResult cut = space.scene().run();
  EXPECT_THAT(cut.err, HasSubstr("edit 1 adds a solid that reaches"));
  EXPECT_NEAR(volume_with(pin, "margin = 20"), all + 2 * 2 * 4, 0.3);
  EXPECT_THAT(space.scene().run().err, ::testing::Not(HasSubstr("edit 1 adds")));
}

// A ring of teeth, turned with its height: flat below and above, with edges at all angles.
TriangleMesh helical_gear(Vec3 size, int teeth, double turn) {  // size: inner, outer radius, height
  constexpr int around_a_tooth = 8, on_the_tooth = 3, layers = 4;
  const int around = teeth * around_a_tooth;
  TriangleMesh mesh;
  for (int layer = 0; layer <= layers; ++layer)
    for (int i = 0; i < around; ++i) {
      const double radius = i % around_a_tooth < on_the_tooth ? size.y : size.x;
      const double angle = 2 * std::numbers::pi * i / around + turn * layer / layers;
      mesh.vertices.push_back(
          {radius * std::cos(angle), radius * std::sin(angle), size.z * layer / layers});
    }
  const auto at = [&](int layer, int i) {
    return static_cast<std::uint32_t>(layer * around + i % around);
  };
  for (int layer = 0; layer < layers; ++layer)
    for (int i = 0; i < around; ++i) {
      mesh.triangles.push_back({at(layer, i), at(layer, i + 1), at(layer + 1, i + 1)});
      mesh.triangles.push_back({at(layer, i), at(layer + 1, i + 1), at(layer + 1, i)});
    }
  const auto below = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.push_back({0, 0, 0});
  mesh.vertices.push_back({0, 0, size.z});
  for (int i = 0; i < around; ++i) {
    mesh.triangles.push_back({below, at(0, i + 1), at(0, i)});
    mesh.triangles.push_back({below + 1, at(layers, i), at(layers, i + 1)});
  }
  return mesh;
}

// Of planes that meet in a line outside a cell's faces one end of it was taken: half a cell off.
TEST(MeshInput, NoVertexOfAGearLiesBelowItsFlatBottom) {
  const MeshInputScene space;
  constexpr double height = 16.204008272302865, outer = 33.687143774591625;
  write_off(space.at("gear.off"), helical_gear({30, outer, height}, 12, 0.2749426381032505));
  space.set(space.at("gear.off"), "resolution = 140");
  const double cell = 2 * outer / 140;
  const Bounds extent = bounds_of(space.result({"simplify.tolerance=0.02"}));
  EXPECT_GT(extent.lo.z, -0.05 * cell);
  EXPECT_LT(extent.hi.z, height + 0.05 * cell);
}

TEST(MeshInput, NeitherPartitionNorStagesMatter) {
  const MeshInputScene space;
  TriangleMesh mesh = dented_ball({30, 30, 30}, 20, 5);
  for (Vec3& v : mesh.vertices) v.x = std::round(2 * v.x) / 2;
  write_off(space.at("a.off"), mesh);
  space.set(space.at("a.off"), "resolution = 90", "[output]\ntile_vertices = 1024\n");
  const Tree expected = space.scene().expect_one_tree(
      {}, {Settings{"work.brick=32", "run.threads=1"},
           {"work.brick=16", "work.shard=2"},
           {"work.copy=true", "work.brick=16", "work.shard=1", "work.chunk=16"}});
  // One command a stage, in parts and not.
  const Settings parts = space.scene().in("parts") + Settings{"work.brick=16", "work.shard=2"};
  const auto stage = [&](const std::string& name, const std::string& part) {
    VOXWELD_EXPECT_DONE(space.scene().command_with(
        name, parts, part.empty() ? Arguments{} : Arguments{"--part", part}));
  };
  stage("ingest", "");
  for (const char* part : {"1/3", "0/3", "2/3"}) stage("build", part);
  stage("merge", "");
  for (const char* part : {"0/2", "1/2"}) stage("stitch", part);
  stage("encode", "");
  EXPECT_EQ(difference(expected, output_tree(space.scene().output("parts"))), "");
}

TEST(MeshInput, EditsWithoutEffectAreCountedFromTheConfigsFirst) {
  const MeshInputScene space;
  write_off(space.at("a.off"), dented_ball({}, 10, 3));
  space.set(space.at("a.off"), "resolution = 20",
            "[[edit]]\nop = \"subtract\"\nshape = \"sphere\"\ncenter = [500, 0, 0]\nradius = 3\n");
  const ProgramResult run = space.scene().run();
  VOXWELD_EXPECT_DONE(run);
  EXPECT_THAT(run.err, HasSubstr("edit 1 changes nothing: it lies outside the volume"));
}

TEST(MeshInput, WhatIsInTheFileCountsNotItsNameOrTime) {
  const MeshInputScene space;
  TriangleMesh mesh = dented_ball({}, 10, 3);
  write_off(space.at("a.off"), mesh);
  space.set(space.at("a.off"), "resolution = 40");
  const std::string first = space.bytes();
  write_off(space.at("a.off"), mesh);  // a new time
  fs::rename(space.at("a.off"), space.at("b.off"));
  space.set(space.at("b.off"), "resolution = 40");
  EXPECT_EQ(space.bytes(), first);
  auto units = units_run(space.scene().output());
  EXPECT_EQ(units["build"] + units["check"] + units["stitch"] + units["encode"], 0U);
  // The same box, so the same lattice.
  for (Vec3& v : mesh.vertices)
    if (std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}) < 7) v = v * 1.01;
  write_off(space.at("b.off"), mesh);
  EXPECT_NE(space.bytes(), first);
  const ProgramResult dry = run_voxweld(
      {"run", space.scene().config().string(), "--dry-run", "--set", "input.resolution=50"});
  EXPECT_THAT(dry.out, HasSubstr("missing (input.resolution was 40, is 50)"));
}

// Coordinates of files are floats: those of a mesh far away are less by what the manifest says.
TEST(MeshInput, FarFromZero) {
  const MeshInputScene space;
  const Vec3 lo{500000, 5400000, 300}, hi{500008, 5400006, 305};
  write_off(space.at("far.off"), box_mesh(lo, hi));
  space.set(space.at("far.off"), "cell = 0.25",
            "[[edit]]\nop = \"subtract\"\nshape = \"box\"\ncenter = [500008, 5400006, 305]\n"
            "size = [4.1, 2.1, 2.1]\n");
  const TriangleMesh result = space.result();
  expect_good(space.scene().output());
  const auto frame = manifest_of(space.scene().output()).at("frame");
  const auto& o = frame.at("origin");
  const Vec3 origin{o.at(0).get<double>(), o.at(1).get<double>(), o.at(2).get<double>()};
  EXPECT_EQ(frame.at("first"), (nlohmann::json{0, 0, 0}));
  expect_extent(moved_mesh(result, origin), lo, hi, 0.003);
  EXPECT_NEAR(volume_of(result), 8 * 6 * 5 - 2.05 * 1.05 * 1.05, 0.1);
  EXPECT_THAT(space.scene().run().err, HasSubstr("which is in frame.origin of the manifest"));
}

TEST(MeshInput, RefusedMeshes) {
  const MeshInputScene space;
  const auto error = [&](const std::string& input) {
    space.set(space.at("a.off"), input);
    const ProgramResult result = space.scene().run();
    EXPECT_EQ(result.exit_code, 2) << result.err;
    return result.err;
  };
  EXPECT_THAT(error("resolution = 50"), HasSubstr("a.off: no such mesh file; check the path"));
  TriangleMesh mesh = dented_ball({}, 10, 3);
  mesh.triangles.pop_back();
  write_off(space.at("a.off"), mesh);
  EXPECT_THAT(error("resolution = 50"),
              HasSubstr("a.off: the mesh is not closed, so it has no inside: 3 of its edges have "
                        "an odd number of triangles, in 1 hole ("));
  std::ofstream(space.at("a.off")) << "OFF\n3 1 0\n0 0 0\n0 1 0\nnan 0 1\n3 0 1 2\n";
  EXPECT_THAT(error("resolution = 50"), HasSubstr("has a coordinate nan; expected finite numbers"));
  std::ofstream(space.at("a.off")) << "OFF\n3 0 0\n0 0 0\n0 1 0\n1 0 1\n";
  EXPECT_THAT(error("resolution = 50"), HasSubstr("a.off: no triangles"));
  write_off(space.at("a.off"), box_mesh({0, 0, 0}, {1, 1, 100}));
  EXPECT_THAT(error("cell = 30"), HasSubstr("the mesh is 100 across, 3.33 cells; expected at least "
                                            "4 cells, so lower it to 25 or less"));
  EXPECT_THAT(error("cell = 1e-4"),
              HasSubstr("input.cell = 0.0001: the mesh is 100 across, which takes 1000006 samples "
                        "with input.margin = 1; at most 524287 fit a side, so input.cell = "
                        "0.000190738 or input.resolution = 524281 is possible"));
  EXPECT_THAT(error("resolution = 520000\nmargin = 10000"),
              HasSubstr("input.resolution = 520000: the mesh is 100 across, which takes 540004"));
  EXPECT_THAT(error("cell = 4"), HasSubstr("no sample lies inside the mesh; raise "
                                           "input.resolution or lower input.cell, which is 4"));
  // Two triangles back to back enclose nothing.
  std::ofstream(space.at("a.off")) << "OFF\n3 2 0\n0 0 0\n0 9 0\n0 0 9\n3 0 1 2\n3 0 2 1\n";
  EXPECT_THAT(error("resolution = 50"), HasSubstr("no sample lies inside the mesh"));
}

TEST(MeshInput, PlanLooksAtIt) {
  const MeshInputScene space;
  write_off(space.at("a.off"), dented_ball({}, 10, 4));
  space.set(space.at("a.off"), "resolution = 100");
  const ProgramResult plan = run_voxweld({"plan", space.scene().config().string()});
  VOXWELD_EXPECT_DONE(plan);
  EXPECT_THAT(plan.out, HasSubstr("Estimated from 8 of 8 bricks (100 % with a surface)"));
}

}  // namespace
}  // namespace voxweld::testing
