// Meshes as solids against plain geometry: exact where lattice points lie on faces, edges and
// corners, by winding numbers elsewhere.
#include "stages/solids/mesh_solid.h"

#include <gtest/gtest.h>

#include "stages/build/hermite.h"
#include "tests/stages/sampled_solid.h"

namespace voxweld {
namespace {

using testing::box_mesh;
using testing::dented_ball;
using testing::nearest;
using testing::tetrahedron;

using Sampled = testing::Sampled<MeshSolid>;

// On the surface, to what snapping moves, and out of the inside end.
void expect_crossings_on_surface(const Sampled& sampled, const TriangleMesh& mesh) {
  std::size_t count = 0;
  sampled.each_crossing([&](int axis, Index3 s, const MeshSolid::Crossing& c) {
    ++count;
    EXPECT_GE(c.t, 0);
    EXPECT_LE(c.t, 1);
    Vec3 p = sampled.frame.place_of_sample(s);
    p[axis] += c.t * sampled.frame.spacing[axis];
    EXPECT_LT(nearest(mesh, p), 1e-5) << axis << ": " << s.x << ' ' << s.y << ' ' << s.z;
    EXPECT_NEAR(dot(c.normal, c.normal), 1, 1e-12);
    EXPECT_EQ(c.normal[axis] > 0, sampled.at(s));
  });
  EXPECT_GT(count, 0U);
}

TEST(MeshSolid, BoxWithFacesOnLatticePoints) {
  const TriangleMesh box = box_mesh({2, 3, 1}, {5, 7, 4});
  const Sampled sampled(box, {{9, 9, 9}, {1, 1, 1}});
  // On the surface: inside where a step to higher coordinates leads in.
  sampled.each_sample([&](Index3 s) {
    EXPECT_EQ(sampled.at(s), s.x >= 2 && s.x < 5 && s.y >= 3 && s.y < 7 && s.z >= 1 && s.z < 4);
  });
  sampled.each_crossing([&](int axis, Index3 s, const MeshSolid::Crossing& c) {
    EXPECT_EQ(c.t, 1);
    Vec3 normal;
    normal[axis] = sampled.at(s) ? 1 : -1;
    EXPECT_EQ(c.normal, normal);
  });
}

TEST(MeshSolid, BoxBetweenLatticePoints) {
  const Sampled sampled(box_mesh({1, 1, 1}, {4, 4.5, 3}), {{9, 9, 9}, {0.8, 0.5, 0.75}});
  sampled.each_crossing([&](int axis, Index3 s, const MeshSolid::Crossing& c) {
    Vec3 low = sampled.frame.place_of_sample(s);
    const double place = low[axis] + c.t * sampled.frame.spacing[axis];
    EXPECT_NEAR(place, sampled.at(s) ? (Vec3{4, 4.5, 3})[axis] : 1, 1e-6);
  });
}

// Whether p moved by (e, e^2, e^3) is inside the tetrahedron, in small whole numbers.
bool in_tetrahedron(const TriangleMesh& mesh, Vec3 p) {
  int sign = 0;
  for (const auto& t : mesh.triangles) {
    const Vec3 a = mesh.vertices[t[0]];
    const Vec3 n = cross(mesh.vertices[t[1]] - a, mesh.vertices[t[2]] - a);
    int here = 0;
    for (const double term : {dot(n, p - a), n.x, n.y, n.z})
      if (here == 0) here = term > 0 ? 1 : term < 0 ? -1 : 0;
    if (here == 0 || (sign != 0 && here != sign)) return false;
    sign = here;
  }
  return true;
}

// Corners on lattice points and halfway between them: rows run through corners and along edges and
// faces.
TEST(MeshSolid, TetrahedraAtNastyPlaces) {
  std::mt19937 random(7);
  std::uniform_int_distribution<int> halves(0, 14);
  for (int round = 0; round < 300; ++round) {
    std::array<Vec3, 4> corners;
    for (Vec3& c : corners)
      for (int a = 0; a < 3; ++a) c[a] = (round % 2 == 0 ? 1.0 : 0.5) * (halves(random) / 2);
    TriangleMesh mesh = tetrahedron(corners);
    if (testing::volume_of(mesh) == 0) continue;
    const Sampled sampled(mesh, {{9, 9, 9}, {1, 1, 1}});
    sampled.each_sample([&](Index3 s) {
      EXPECT_EQ(sampled.at(s), in_tetrahedron(mesh, sampled.frame.place_of_sample(s)));
    });
    sampled.each_crossing([&](int axis, Index3 s, const MeshSolid::Crossing& c) {
      Vec3 p = sampled.frame.place_of_sample(s);
      p[axis] += c.t;
      EXPECT_LT(nearest(mesh, p), 1e-9);
      EXPECT_EQ(c.normal[axis] > 0, sampled.at(s));
    });
  }
}

TEST(MeshSolid, TurnedMeshesAgreeWithWindingNumbers) {
  std::mt19937 random(11);
  const VolumeFrame frame{{24, 20, 16}, {1, 1.2, 1.5}};
  for (int round = 0; round < 6; ++round) {
    TriangleMesh mesh = round % 2 == 0 ? testing::subdivided(box_mesh({-7, -5, -6}, {7, 5, 6}))
                                       : dented_ball({}, 7.5, 4);
    testing::turn(mesh, random);
    for (Vec3& v : mesh.vertices) v = v + Vec3{11.3, 11.1, 11.7};
    const Sampled sampled(mesh, frame);
    sampled.each_sample([&](Index3 s) {
      const Vec3 p = frame.place_of_sample(s);
      if (nearest(mesh, p) < 1e-5) return;
      EXPECT_EQ(sampled.at(s), std::lround(testing::winding(mesh, p)) % 2 != 0);
    });
    expect_crossings_on_surface(sampled, mesh);
  }
}

// Corners rounded to lattice points and to halves: degenerate triangles, edges along rows, corners
// on rows, all at once.
TEST(MeshSolid, EveryEdgeWithASideChangeHasACrossing) {
  for (const double grid : {1.0, 0.5}) {
    TriangleMesh mesh = dented_ball({8, 8, 8}, 6, 5);
    for (Vec3& v : mesh.vertices)
      for (int a = 0; a < 3; ++a) v[a] = std::round(v[a] / grid) * grid;
    expect_crossings_on_surface(Sampled(mesh, {{17, 17, 17}, {1, 1, 1}}), mesh);
  }
}

TEST(MeshSolid, OrderWindingAndBoxOfTheQuestionChangeNothing) {
  TriangleMesh mesh = dented_ball({8, 8, 8}, 6, 5);
  for (Vec3& v : mesh.vertices) v.x = std::round(v.x * 2) / 2;
  const VolumeFrame frame{{17, 17, 17}, {1, 1, 1}};
  const Sampled first(mesh, frame);
  std::mt19937 random(3);
  std::shuffle(mesh.triangles.begin(), mesh.triangles.end(), random);
  for (auto& t : mesh.triangles)
    if (random() % 2 != 0) std::swap(t[0], t[1]);
  const Sampled second(mesh, frame);
  EXPECT_EQ(first.inside, second.inside);
  first.each_crossing([&](int axis, Index3 s, const MeshSolid::Crossing& c) {
    const auto other = second.mesh.crossing(axis, s, second.at(s));
    EXPECT_EQ(c.t, other.t);
    EXPECT_EQ(c.normal, other.normal);
  });
  first.expect_sides_of_boxes(random);
}

// Two walls within one edge: the one next to the outside end is taken.
TEST(MeshSolid, OfSeveralCrossingsTheOutermost) {
  const TriangleMesh mesh = testing::joined(box_mesh({1.5, 0.5, 0.5}, {4.2, 3.5, 3.5}),
                                            box_mesh({4.5, 0.5, 0.5}, {4.7, 3.5, 3.5}));
  const Sampled sampled(mesh, {{7, 5, 5}, {1, 1, 1}});
  const auto crossing = sampled.mesh.crossing(0, {4, 2, 2}, true);
  EXPECT_NEAR(crossing.t, 0.7, 1e-6);
  EXPECT_EQ(crossing.normal, (Vec3{1, 0, 0}));
}

// The lattice may cut the mesh, and rows are many more than bins.
TEST(MeshSolid, ReachesBeyondTheLattice) {
  const Sampled sampled(box_mesh({-1e5, 3.5, -20}, {1e5, 300.5, 120.5}),
                        {{20, 400, 200}, {1, 1, 1}});
  sampled.each_sample(
      [&](Index3 s) { EXPECT_EQ(sampled.at(s), s.y > 3 && s.y <= 300 && s.z <= 120); });
  EXPECT_LT(sampled.mesh.bytes(), 10000U);
}

TEST(MeshSolid, SignGridAndHermiteEdgesTakeIt) {
  const VolumeFrame frame{{30, 30, 30}, {1, 1, 1}};
  Edit edit;
  edit.solid.shape = SolidShape::mesh;
  edit.solid.mesh = std::make_shared<MeshSolid>(dented_ball({15, 15, 15}, 9, 4), frame, Hash128{});
  const Sampled sampled(dented_ball({15, 15, 15}, 9, 4), frame);
  for (const Index3 brick : {Index3{0, 0, 0}, Index3{16, 0, 16}, Index3{16, 16, 16}}) {
    SignGrid signs;
    signs.fill(edit.solid, frame, brick, 16);
    HermiteEdges before, edges;
    SignGrid none;
    none.fill(HaloBlock{}, brick, 16, {});
    before.compute(edit, frame, brick, 16, none, none, before);
    edges.compute(edit, frame, brick, 16, signs, signs, before);
    EXPECT_GT(edges.size(), 100U);
    for (int z = -1; z <= 17; ++z)
      for (int y = -1; y <= 17; ++y)
        for (int x = -1; x <= 17; ++x) {
          const Index3 s = brick + Index3{x, y, z} - splat(1);
          const bool real = Box3{{}, frame.size}.contains(s);
          ASSERT_EQ(signs.inside(x, y, z), real && sampled.at(s));
        }
  }
}

}  // namespace
}  // namespace voxweld
