// Meshes with holes and overlaps on a lattice: against closed meshes, and against winding numbers.
#include "stages/solids/wound_mesh.h"

#include <gtest/gtest.h>

#include "tests/stages/sampled_solid.h"

namespace voxweld {
namespace {

using testing::box_mesh;
using testing::dented_ball;

using SampledWound = testing::Sampled<WoundMesh>;

// Faces and corners on lattice points or not: what parity tells of closed meshes.
TEST(WoundMesh, ClosedMeshesAreAsByParity) {
  std::mt19937 random(5);
  const VolumeFrame frames[] = {{{17, 17, 17}, {1, 1, 1}}, {{15, 17, 19}, {1.2, 1, 0.8}}};
  for (const VolumeFrame& frame : frames)
    for (int round = 0; round < 6; ++round) {
      TriangleMesh mesh = round % 2 == 0 ? dented_ball({8, 8, 8}, 5, 4)
                                         : testing::subdivided(box_mesh({3, 2, 4}, {11, 12, 13}));
      if (round > 1)
        for (Vec3& v : mesh.vertices) v.x = std::round(2 * v.x) / 2;
      if (round == 5)
        for (Vec3& v : mesh.vertices) v = {std::round(v.x), std::round(v.y), std::round(v.z)};
      const SampledWound sampled(mesh, frame);
      const MeshSolid parity(mesh, frame, {});
      EXPECT_EQ(sampled.inside, testing::sides_of(parity, {{}, frame.size}));
      EXPECT_EQ(sampled.mesh.open_edges(), 0U);
      std::size_t edges = 0, far = 0, turned = 0;
      sampled.each_crossing([&](int axis, Index3 s, const LatticeSolid::Crossing& c) {
        const auto expected = parity.crossing(axis, s, sampled.at(s));
        ++edges;
        far += std::abs(c.t - expected.t) > 1e-5 ? 1 : 0;
        turned += dot(c.normal, expected.normal) < 1 - 1e-9 ? 1 : 0;
        EXPECT_EQ(c.normal[axis] > 0, sampled.at(s));
      });
      EXPECT_GT(edges, 200U);
      EXPECT_EQ(far, 0U);
      // On an edge of two triangles either is as good.
      EXPECT_LE(turned, edges / (round > 1 ? 20 : 100));
    }
}

TEST(WoundMesh, SidesAreThoseOfTheWindingNumber) {
  std::mt19937 random(6);
  const VolumeFrame frame{{22, 20, 18}, {1, 1.1, 1.25}};
  for (int round = 0; round < 4; ++round) {
    TriangleMesh mesh = dented_ball({11.2, 10.9, 11.1}, 7, 4);
    std::erase_if(mesh.triangles, [&](const auto&) { return random() % 100 < 4U << round; });
    const SampledWound sampled(mesh, frame);
    std::size_t inside = 0;
    sampled.each_sample([&](Index3 s) {
      const double number = testing::winding(mesh, frame.place_of_sample(s));
      if (std::abs(number - 0.5) < 1e-4) return;
      bool within = true;
      for (int a = 0; a < 3; ++a)
        within = within && frame.place_of_sample(s)[a] >= sampled.mesh.bounds().lo[a] &&
                 frame.place_of_sample(s)[a] <= sampled.mesh.bounds().hi[a];
      EXPECT_EQ(sampled.at(s), within && number > 0.5);
      inside += sampled.at(s) ? 1 : 0;
    });
    EXPECT_GT(inside, 300U);
    sampled.each_crossing([&](int axis, Index3 s, const LatticeSolid::Crossing& c) {
      EXPECT_GE(c.t, 0);
      EXPECT_LE(c.t, 1);
      EXPECT_NEAR(dot(c.normal, c.normal), 1, 1e-12);
      EXPECT_EQ(c.normal[axis] > 0, sampled.at(s));
    });
  }
}

// Its box is the mesh's own on all axes: it does not reach to 0 on any.
TEST(WoundMesh, BoundsAreThoseOfTheTrianglesAlone) {
  for (const Vec3 lo : {Vec3{3, 5, 7}, Vec3{-11, -13, -12}}) {
    const TriangleMesh mesh = box_mesh(lo, lo + Vec3{4, 2, 3});
    const WoundMesh wound(mesh, {{20, 20, 20}, {1, 0.5, 2}}, {});
    for (int a = 0; a < 3; ++a) {
      EXPECT_NEAR(wound.bounds().lo[a], lo[a], 1e-5) << a;
      EXPECT_NEAR(wound.bounds().hi[a], (lo + Vec3{4, 2, 3})[a], 1e-5) << a;
    }
  }
}

// A box without its top: across the hole the number is 1/2 in the plane of its rim.
TEST(WoundMesh, FlatHolesCloseFlat) {
  TriangleMesh mesh = box_mesh({3.3, 4.4, 2.2}, {17.6, 15.7, 13.4});
  std::erase_if(mesh.triangles, [&](const auto& t) {
    return mesh.vertices[t[0]].z > 13 && mesh.vertices[t[1]].z > 13 && mesh.vertices[t[2]].z > 13;
  });
  ASSERT_EQ(mesh.triangles.size(), 10U);
  const SampledWound sampled(mesh, {{21, 21, 21}, {1, 1, 1}});
  std::size_t across = 0;
  sampled.each_sample([&](Index3 s) {
    EXPECT_EQ(sampled.at(s), s.x > 3 && s.x < 18 && s.y > 4 && s.y < 16 && s.z > 2 && s.z < 14);
  });
  sampled.each_crossing([&](int axis, Index3 s, const LatticeSolid::Crossing& c) {
    if (axis != 2 || s.z < 5) return;
    ++across;
    EXPECT_NEAR(c.t, 0.4, 1e-5);
    EXPECT_NEAR(c.normal.z, 1, 1e-5);
  });
  EXPECT_EQ(across, 14U * 11U);
}

TEST(WoundMesh, OverlappingBoxesAreOneSolid) {
  const TriangleMesh mesh = testing::joined(box_mesh({2.5, 2.5, 2.5}, {10.5, 10.5, 10.5}),
                                            box_mesh({6.5, 6.5, 6.5}, {14.5, 14.5, 14.5}));
  const SampledWound sampled(mesh, {{18, 18, 18}, {1, 1, 1}});
  const auto in = [](Index3 s, std::int64_t lo, std::int64_t hi) {
    return std::min({s.x, s.y, s.z}) >= lo && std::max({s.x, s.y, s.z}) <= hi;
  };
  sampled.each_sample([&](Index3 s) { EXPECT_EQ(sampled.at(s), in(s, 3, 10) || in(s, 7, 14)); });
  sampled.each_crossing([&](int axis, Index3 s, const LatticeSolid::Crossing& c) {
    EXPECT_NEAR(c.t, 0.5, 1e-5);
    Vec3 normal;
    normal[axis] = sampled.at(s) ? 1 : -1;
    EXPECT_EQ(c.normal, normal);
  });
}

TEST(WoundMesh, BoxOfTheQuestionChangesNothing) {
  std::mt19937 random(9);
  TriangleMesh mesh = dented_ball({8, 8, 8}, 6, 4);
  std::erase_if(mesh.triangles, [&](const auto&) { return random() % 10 == 0; });
  SampledWound(mesh, {splat(17), {1, 1, 1}}).expect_sides_of_boxes(random);
}

TEST(WoundMesh, IsKeyedByHowItTellsSides) {
  const VolumeFrame frame{{9, 9, 9}, {1, 1, 1}};
  const TriangleMesh mesh = box_mesh({1, 1, 1}, {5, 5, 5});
  const Hash128 content = hash_bytes({});
  EXPECT_NE(WoundMesh(mesh, frame, content).source(), MeshSolid(mesh, frame, content).source());
}

}  // namespace
}  // namespace voxweld
