// Triangles around one vertex, whichever way they face, against the exact test of each pair.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <random>

#include "stages/refine/edit_mesh.h"
#include "stages/refine/find_pairs.h"
#include "stages/stitch/lattice_plan.h"

namespace voxweld {
namespace {

struct Shape {
  std::array<double, 2>
      steep;  // how far down edges go for each step outwards, from the least to the most
  std::size_t triangles = 9;  // the first of the nine
  double jitter = 0.3;        // of directions, in angles between two of them
};

// Nine triangles around a vertex, `turns` times, seen from `towards`, a unit vector.
RefineMesh umbrella(int turns, Vec3 towards, const Shape& shape, std::mt19937& random) {
  constexpr std::size_t count = 9;
  const Vec3 some = std::abs(towards.x) < 0.5 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  Vec3 right = cross(some, towards);
  right = right * (1 / std::sqrt(dot(right, right)));
  const Vec3 up = cross(towards, right);
  RefineMesh mesh;
  const auto add = [&](Vec3 p) {
    mesh.ids.push_back({mesh.positions.size()});
    mesh.positions.push_back({static_cast<std::int32_t>(std::lround(p.x)),
                              static_cast<std::int32_t>(std::lround(p.y)),
                              static_cast<std::int32_t>(std::lround(p.z))});
  };
  const Vec3 centre{4000, 4000, 4000};
  add(centre);
  std::uniform_real_distribution<double> part;
  for (std::size_t i = 0; i < count; ++i) {
    const double angle = 2 * std::numbers::pi * turns *
                         (static_cast<double>(i) + shape.jitter * part(random)) /
                         static_cast<double>(count);
    const double down = shape.steep[0] + (shape.steep[1] - shape.steep[0]) * part(random);
    const Vec3 out = right * std::cos(angle) + up * std::sin(angle) - towards * down;
    add(centre + out * (200 + 200 * part(random)));
    const auto next = static_cast<std::uint32_t>(1 + (i + 1) % count);
    mesh.triangles.push_back({0, static_cast<std::uint32_t>(i + 1), next});
  }
  mesh.triangles.resize(shape.triangles);
  return mesh;
}

std::vector<std::uint32_t> that_intersect(const EditMesh& mesh) {
  std::vector<std::uint32_t> found;
  for (std::uint32_t a = 0; a < mesh.triangles(); ++a)
    for (std::uint32_t b = 0; b < mesh.triangles(); ++b)
      if (a != b && intersect_beyond_shared(mesh.shape(a), mesh.shape(b))) {
        found.push_back(a);
        break;
      }
  return found;
}

Vec3 any_direction(std::mt19937& random) {
  std::normal_distribution<double> normal;
  const Vec3 v{normal(random), normal(random), normal(random)};
  return v * (1 / std::sqrt(dot(v, v)));
}

class Umbrella : public ::testing::TestWithParam<int> {
 protected:
  // How many of a hundred intersect; each is found to do so or not as it does.
  std::size_t count(const Shape& shape) {
    std::size_t intersecting = 0;
    const RefineFrame frame{plan_lattice({splat(64), {1, 1, 1}, 0.01}), {1, 1, 1}, {}, splat(64)};
    for (int round = 0; round < 100; ++round) {
      const RefineMesh mesh = umbrella(GetParam(), any_direction(random_), shape, random_);
      EditMesh edit(mesh, {{0, 0, 0}, {8000, 8000, 8000}});
      const std::vector<std::uint32_t> expected = that_intersect(edit);
      EXPECT_EQ(edit.find_intersecting(), expected) << round;
      EXPECT_EQ(find_range_pairs(mesh, CubeLattice(frame, 0), {}).intersecting, expected) << round;
      intersecting += expected.empty() ? 0 : 1;
    }
    return intersecting;
  }

  std::mt19937 random_{11};
};

// Once around, each triangle has directions of its own.
TEST_P(Umbrella, IsFlat) {
  EXPECT_EQ(count({.steep = {-0.1, 0.1}}), GetParam() == 1 ? 0u : 100u);
}

TEST_P(Umbrella, IsSteep) {
  EXPECT_EQ(count({.steep = {2, 3}}), GetParam() == 1 ? 0u : 100u);
}

TEST_P(Umbrella, GoesUpAndDown) {
  EXPECT_EQ(count({.steep = {-4, 4}}), GetParam() == 1 ? 0u : 100u);
}

// Some face away, and back.
TEST_P(Umbrella, IsTangled) {
  const std::size_t found = count({.steep = {0.5, 3}, .jitter = 3});
  EXPECT_GT(found, 30u);
  EXPECT_LE(found, GetParam() == 1 ? 99u : 100u);
}

// No ring: what goes around more than once lies above itself.
TEST_P(Umbrella, IsOpen) {
  EXPECT_EQ(count({.steep = {0.5, 3}, .triangles = 6}) > 10, GetParam() == 2);
}

INSTANTIATE_TEST_SUITE_P(Turns, Umbrella, ::testing::Values(1, 2));

}  // namespace
}  // namespace voxweld
