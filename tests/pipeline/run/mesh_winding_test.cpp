// Meshes with holes and overlaps, closed by their winding number, end to end.
#include <gmock/gmock.h>

#include "stages/solids/mesh_boundary.h"
#include "storage/meshes/mesh_file.h"
#include "tests/pipeline/run/mesh_scene.h"
#include "tests/support/test_names.h"
#include "tests/support/triangle_meshes.h"

namespace voxweld::testing {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

// All triangles within a distance of one of the places are gone.
TriangleMesh with_holes(TriangleMesh mesh, const std::vector<Vec3>& places, double radius) {
  std::erase_if(mesh.triangles, [&](const auto& t) {
    const Vec3 middle =
        (mesh.vertices[t[0]] + mesh.vertices[t[1]] + mesh.vertices[t[2]]) * (1.0 / 3);
    return std::ranges::any_of(
        places, [&](Vec3 p) { return dot(middle - p, middle - p) < radius * radius; });
  });
  return mesh;
}

class Holes : public ::testing::TestWithParam<const char*> {};

// Triangles here and there are gone, and what hangs together of a few: the closed volume comes out.
TEST_P(Holes, CloseToTheVolumeThatWas) {
  const fs::path path = shared_mesh(GetParam());
  if (path.empty()) GTEST_SKIP() << GetParam() << " is not there";
  const TriangleMesh mesh = read_mesh_file(path).mesh;
  std::vector<Vec3> places;
  for (std::size_t i = 1; i <= 6; ++i)
    places.push_back(mesh.vertices[i * mesh.vertices.size() / 7]);
  const auto [lo, hi] = bounds_of(mesh);
  const double longest = std::max({hi.x - lo.x, hi.y - lo.y, hi.z - lo.z});
  TriangleMesh open = with_holes(mesh, places, 0.03 * longest);
  const std::size_t gone = mesh.triangles.size() - open.triangles.size();
  EXPECT_GT(gone, 20U);
  const MeshInputScene space;
  write_off(space.at("open.off"), open);
  space.set(space.at("open.off"), "resolution = 128");
  const ProgramResult refused = space.scene().run();
  expect_refused(refused, "close it in a mesh editor, or with close = \"winding\"");
  const TriangleMesh result = space.result({"input.close=winding"});
  expect_good(space.scene().output());
  const double volume = std::abs(volume_of(mesh));
  const double cell = longest / 128;
  std::vector<Vec3> near;  // what the holes left
  for (const auto& t : open.triangles) near.push_back(open.vertices[t[0]]);
  const Spread missed = distances(near, result, cell);
  std::printf(
      "%s: %zu triangles gone; volume %+.4f %%; cells from the others' corners to what came "
      "out: mean %.4f, most %.3f\n",
      GetParam(), gone, 100 * (volume_of(result) / volume - 1), missed.mean(), missed.most);
  EXPECT_NEAR(volume_of(result), volume, 0.01 * volume);
  EXPECT_LT(missed.mean(), 0.1);
}

INSTANTIATE_TEST_SUITE_P(MeshWinding, Holes,
                         ::testing::Values("meshes/fandisk.obj", "meshes/rocker-arm.obj",
                                           "meshes/anchor_dense.off"),
                         [](const auto& tested) { return test_name(tested.param); });

TEST(MeshWinding, OfAClosedMeshIsAsByParity) {
  const MeshInputScene space;
  const TriangleMesh mesh = dented_ball({100, -3, 7}, 20, 5);
  write_off(space.at("a.off"), mesh);
  space.set(space.at("a.off"), "cell = 0.75");
  const TriangleMesh closed = space.result();
  const TriangleMesh wound = space.result({"input.close=winding"});
  EXPECT_NEAR(volume_of(wound), volume_of(closed), 1e-4 * volume_of(closed));
  EXPECT_NEAR(static_cast<double>(wound.triangles.size()),
              static_cast<double>(closed.triangles.size()),
              0.01 * static_cast<double>(closed.triangles.size()));
  EXPECT_LT(distances(wound.vertices, closed, 0.75).most, 0.3);
}

TEST(MeshWinding, WhatOverlapsIsOneSolid) {
  const MeshInputScene space;
  const double one = 10 * 10 * 10, common = 4 * 4 * 4;
  write_off(space.at("a.off"),
            joined(box_mesh({0, 0, 0}, {10, 10, 10}), box_mesh({6, 6, 6}, {16, 16, 16})));
  space.set(space.at("a.off"), "cell = 0.5");
  EXPECT_NEAR(volume_of(space.result()), 2 * one - 2 * common, 6);  // twice is outside again
  EXPECT_NEAR(volume_of(space.result({"input.close=winding"})), 2 * one - common, 6);
  expect_good(space.scene().output());
}

// A box without its top, facing inward at that; as the input and as an edit.
TEST(MeshWinding, OpenBoxes) {
  const MeshInputScene space;
  TriangleMesh box = box_mesh({1, 2, 3}, {9, 8, 7});
  std::erase_if(box.triangles, [&](const auto& t) {
    return box.vertices[t[0]].z == 7 && box.vertices[t[1]].z == 7 && box.vertices[t[2]].z == 7;
  });
  for (auto& t : box.triangles) std::swap(t[0], t[1]);
  write_off(space.at("open.off"), box);
  space.set(space.at("open.off"), "cell = 0.25\nclose = \"winding\"");
  EXPECT_NEAR(volume_of(space.result()), 8 * 6 * 4, 0.4);
  EXPECT_THAT(space.scene().run().err, HasSubstr("open.off: closed by winding number: 1 hole ("));
  write_off(space.at("block.off"), box_mesh({0, 0, 0}, {10, 10, 10}));
  space.set(
      space.at("block.off"), "cell = 0.25",
      "[[edit]]\nop = \"subtract\"\nshape = \"mesh\"\npath = \"open.off\"\nclose = \"winding\"\n");
  EXPECT_NEAR(volume_of(space.result()), 1000 - 8 * 6 * 4, 1);
  expect_good(space.scene().output());
}

TEST(MeshWinding, PartitionDoesNotMatter) {
  const MeshInputScene space;
  const TriangleMesh mesh =
      with_holes(dented_ball({30, 30, 30}, 20, 4), {{50, 30, 30}, {30, 12, 30}, {30, 30, 46}}, 5);
  write_off(space.at("a.off"), mesh);
  space.set(space.at("a.off"), "resolution = 90\nclose = \"winding\"",
            "[output]\ntile_vertices = 1024\n");
  space.scene().expect_one_tree(
      {}, {{"work.brick=32", "run.threads=1"}, {"work.brick=16", "work.shard=2"}});
}

TEST(MeshWinding, ChangesTheKey) {
  const MeshInputScene space;
  write_off(space.at("a.off"), dented_ball({}, 10, 3));
  space.set(space.at("a.off"), "resolution = 40");
  VOXWELD_EXPECT_DONE(space.scene().run());
  const ProgramResult dry = run_voxweld(
      {"run", space.scene().config().string(), "--dry-run", "--set", "input.close=winding"});
  EXPECT_THAT(dry.out, HasSubstr("missing (input.close was \"no\", is \"winding\")"));
}

}  // namespace
}  // namespace voxweld::testing
