// Vertices to where the volume wants them, edges to where its normals do.
#include "stages/refine/vertex_places.h"

#include <gtest/gtest.h>

#include "stages/exact/intersections.h"
#include "tests/stages/refine/volume_mesh.h"

namespace voxweld {
namespace {

constexpr std::int32_t cell = 64;  // in lattice steps

std::array<PackedNormal, max_clusters> packed(const std::vector<Vec3>& directions) {
  std::array<PackedNormal, max_clusters> normals;
  normals.fill(no_normal);
  for (std::size_t i = 0; i < directions.size(); ++i)
    normals[i] = pack_normal(directions[i] * (1 / std::sqrt(dot(directions[i], directions[i]))));
  return normals;
}

// A tent with a floor. Vertices 0 to 2 are its ridge, 3 to 5 the eave at low y, 6 to 8 that at high y.
RefineMesh tent() {
  const Vec3 low{0, -1, 1}, high{0, 1, 1}, down{0, 0, -1};
  const std::array<std::vector<Vec3>, 3> of_row = {{{low, high}, {low, down}, {high, down}}};
  RefineMesh mesh;
  for (std::size_t row = 0; row < 3; ++row)
    for (std::int32_t i = 0; i < 3; ++i) {
      const std::int32_t y = row == 0 ? 0 : row == 1 ? -cell : cell;
      mesh.positions.push_back({100 + cell * i, 200 + y, row == 0 ? 100 + cell : 100});
      std::vector<Vec3> normals = of_row[row];
      if (i != 1) normals.push_back({static_cast<double>(i - 1), 0, 0});
      mesh.normals.push_back(packed(normals));
      mesh.ids.push_back({mesh.ids.size()});
    }
  mesh.aims = mesh.positions;
  for (std::uint32_t i = 0; i < 2; ++i) {
    const std::uint32_t l = 3 + i, h = 6 + i;
    for (const std::array<std::uint32_t, 3>& t : {std::array{i, l, i + 1},
                                                  {i + 1, l, l + 1},
                                                  {i, i + 1, h + 1},
                                                  {i, h + 1, h},
                                                  {l, h, l + 1},
                                                  {l + 1, h, h + 1}})
      mesh.triangles.push_back(t);
  }
  mesh.triangles.push_back({0, 6, 3});
  mesh.triangles.push_back({2, 5, 8});
  return mesh;
}

using Triangles = std::vector<std::array<std::uint32_t, 3>>;
Triangles in_order(Triangles triangles) {
  for (auto& t : triangles) std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
  std::sort(triangles.begin(), triangles.end());
  return triangles;
}

struct Settled {
  RefineMesh mesh;
  RefineCounts counts;
};
Settled settled(const RefineMesh& mesh) {
  RefineParameters parameters;
  parameters.tolerance = 0.1 * cell;
  parameters.reach = cell;
  EditMesh edit(mesh, {{0, 0, 0}, {1000, 1000, 1000}});
  RefineCounts counts;
  settle_places(edit, parameters, counts);
  return {std::move(edit).take(), counts};
}

TEST(VertexPlaces, ATentStaysAsItIs) {
  const Settled now = settled(tent());
  EXPECT_EQ(now.mesh.positions, tent().positions);
  EXPECT_EQ(in_order(now.mesh.triangles), in_order(tent().triangles));
  EXPECT_EQ(now.counts.moves + now.counts.flips, 0u);
}

TEST(VertexPlaces, AVertexGoesToItsAimAndLeavesNoSample) {
  RefineMesh sagging = tent();
  sagging.positions[1][2] -= 30;
  const Settled now = settled(sagging);
  EXPECT_EQ(now.mesh.positions, tent().positions);
  EXPECT_TRUE(now.mesh.samples.empty());
  EXPECT_EQ(now.counts.moves, 1u);
}

TEST(VertexPlaces, AnAimAgainstTheNormalsIsLeftAlone) {
  RefineMesh mesh = tent();
  mesh.aims[1][1] += 50;
  const Settled now = settled(mesh);
  EXPECT_EQ(now.mesh.positions, tent().positions);
  EXPECT_EQ(now.mesh.aims, now.mesh.positions) << "tried once";
}

TEST(VertexPlaces, WhereSomethingIsInTheWayItGoesSomeOfIt) {
  RefineMesh mesh = tent();
  for (auto& normals : mesh.normals) normals.fill(no_normal);  // which say nothing against it
  mesh.aims[1][2] = 90;                                        // below the floor
  const Settled now = settled(mesh);
  EXPECT_EQ(now.mesh.positions[1][2], 105) << "half of it, and a quarter of the rest";
  std::size_t pairs = 0;
  each_intersection({now.mesh.positions, now.mesh.triangles},
                    [&](std::uint32_t, std::uint32_t) { ++pairs; });
  EXPECT_EQ(pairs, 0u);
}

TEST(VertexPlaces, AnEdgeAcrossTheRidgeIsFlippedBack) {
  RefineMesh cut = tent();
  std::erase_if(cut.triangles, [](const auto& t) {
    return t == std::array<std::uint32_t, 3>{0, 3, 1} || t == std::array<std::uint32_t, 3>{0, 1, 7};
  });
  cut.triangles.push_back({1, 7, 3});
  cut.triangles.push_back({0, 3, 7});
  const Settled now = settled(cut);
  EXPECT_EQ(in_order(now.mesh.triangles), in_order(tent().triangles));
  EXPECT_EQ(now.counts.flips, 1u);
}

// Away from the volume's border the mean distance of vertices from a wedge whose edge runs askew.
double distance_from_wedge(bool with_aims) {
  const double s = 1 / std::sqrt(3.0);
  const Vec3 a{0.8, 0.36, 0.48}, b{-s, s, s};
  const auto wedge = [&](Vec3 p) { return std::max(dot(a, p), dot(b, p)) - 14; };
  const auto at = [](auto p) {
    return Vec3{static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2])};
  };
  const testing::MemoryVolume volume = testing::MemoryVolume::made<float>(
      splat(40), SampleType::f32, [&](Index3 p) { return static_cast<float>(-wedge(as_vec3(p))); });
  testing::VolumeMesh made = testing::mesh_of(volume, 1e-3);
  if (!with_aims) made.mesh.aims = made.mesh.positions;
  const double step = made.frame.lattice.step;
  RefineParameters parameters;
  parameters.mode = RefineMode::repair;
  parameters.reach = 1 / step;
  parameters.tolerance = 0.1 / step;
  RefineCounts counts;
  const RefineMesh mesh =
      refine_range(made.mesh, CubeLattice(made.frame, 0), {}, parameters, counts);
  double sum = 0, worst = 0;
  std::size_t vertices = 0;
  for (const LatticePoint& p : mesh.positions) {
    const Vec3 place = at(p) * step - Vec3{1, 1, 1};
    if (std::min({place.x, place.y, place.z}) < 4 || std::max({place.x, place.y, place.z}) > 35)
      continue;
    ++vertices;
    sum += std::abs(wedge(place));
    worst = std::max(worst, std::abs(wedge(place)));
  }
  EXPECT_GT(vertices, 100u);
  return sum / static_cast<double>(vertices);
}

TEST(VertexPlaces, SharpEdgesAreNearerOutsideOfCells) {
  const double held = distance_from_wedge(false), free = distance_from_wedge(true);
  EXPECT_LT(free, 0.7 * held) << held;
}

}  // namespace
}  // namespace voxweld
