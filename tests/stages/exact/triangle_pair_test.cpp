// Pairs of triangles against the theorem of separating axes, which is another way altogether.
#include "stages/exact/triangle_pair.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "stages/exact/orientation.h"

namespace voxweld {
namespace {

Index3 vector_of(const LatticePoint& p) {
  return {p[0], p[1], p[2]};
}
std::int64_t dot_of(Index3 a, Index3 b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

// Two flat convex sets have a point in common. For small coordinates.
bool meet(const std::vector<LatticePoint>& a, const std::vector<LatticePoint>& b) {
  std::vector<Index3> edges, axes;
  std::array<Index3, 2> normals;
  int set = 0;
  for (const auto* points : {&a, &b}) {
    for (std::size_t i = 0; i < points->size(); ++i)
      edges.push_back(lattice_vector((*points)[i], (*points)[(i + 1) % points->size()]));
    normals[static_cast<std::size_t>(set++)] =
        points->size() == 3 ? exact_normal((*points)[0], (*points)[1], (*points)[2]) : Index3{};
  }
  edges.push_back(lattice_vector(a[0], b[0]));  // for what is parallel
  for (const Index3& n : normals) {
    axes.push_back(n);
    for (const Index3& e : edges) axes.push_back(exact_cross(n, e));
  }
  // What separates crosses an edge of either, or lies in a plane of two, or along one.
  for (const Index3& e : edges)
    for (const Index3& f : edges) {
      const Index3 both = exact_cross(e, f);
      axes.insert(axes.end(), {e, both, exact_cross(both, e), exact_cross(both, f)});
    }
  return std::ranges::none_of(axes, [&](const Index3& axis) {
    const auto range = [&](const std::vector<LatticePoint>& points) {
      std::int64_t lo = dot_of(axis, vector_of(points[0])), hi = lo;
      for (const LatticePoint& p : points) {
        lo = std::min(lo, dot_of(axis, vector_of(p)));
        hi = std::max(hi, dot_of(axis, vector_of(p)));
      }
      return std::pair(lo, hi);
    };
    const auto [a_lo, a_hi] = range(a);
    const auto [b_lo, b_hi] = range(b);
    return a_hi < b_lo || b_hi < a_lo;
  });
}

bool expected(const LatticeTriangle& a, const LatticeTriangle& b) {
  std::vector<LatticePoint> shared, rest_a, rest_b;
  for (const LatticePoint& p : a) (std::ranges::count(b, p) != 0 ? shared : rest_a).push_back(p);
  for (const LatticePoint& p : b)
    if (std::ranges::count(a, p) == 0) rest_b.push_back(p);
  const std::vector<LatticePoint> all_a(a.begin(), a.end()), all_b(b.begin(), b.end());
  switch (shared.size()) {
    case 0:
      return meet(all_a, all_b);
    case 1:
      return meet(rest_a, all_b) || meet(rest_b, all_a);
    case 2: {
      // Beyond the edge: the opposite corner of one is in the other, or their other edges cross.
      for (const LatticePoint& end : shared)
        for (const LatticePoint& other : shared)
          if (end != other && meet({end, rest_a[0]}, {other, rest_b[0]})) return true;
      return meet({rest_a[0], rest_a[0]}, all_b) || meet({rest_b[0], rest_b[0]}, all_a);
    }
    default:
      return true;
  }
}

class Pairs : public ::testing::TestWithParam<int> {};

// So few places that all kinds of touching and overlapping occur.
TEST_P(Pairs, AreAsSeparatingAxesSay) {
  const int side = GetParam();
  std::mt19937_64 random(static_cast<std::uint64_t>(side));
  std::uniform_int_distribution<std::int32_t> any(0, side);
  const auto triangle = [&] {
    LatticeTriangle t;
    for (LatticePoint& p : t) p = {any(random), any(random), any(random)};
    return t;
  };
  int cut[4] = {}, apart[4] = {};
  for (int i = 0; i < 300000; ++i) {
    const LatticeTriangle a = triangle();
    LatticeTriangle b = triangle();
    for (int k = 0; k < i % 3; ++k)
      b[static_cast<std::size_t>(k)] = a[static_cast<std::size_t>(2 - k)];
    if (has_no_area(a) || has_no_area(b)) {
      ASSERT_FALSE(intersect_beyond_shared(a, b));
      continue;
    }
    const bool answer = intersect_beyond_shared(a, b);
    ASSERT_EQ(answer, expected(a, b)) << i;
    const auto shared =
        std::ranges::count_if(a, [&](const auto& p) { return std::ranges::count(b, p); });
    ++(answer ? cut : apart)[shared];
  }
  for (int shared = 0; shared < 3; ++shared) {
    EXPECT_GT(cut[shared], 50) << shared;
    EXPECT_GT(apart[shared], 50) << shared;
  }
}
INSTANTIATE_TEST_SUITE_P(Sides, Pairs, ::testing::Values(2, 3, 5, 20));

TEST(PairsOfTriangles, OrderAndCornersDoNotMatter) {
  std::mt19937_64 random(9);
  std::uniform_int_distribution<std::int32_t> any(0, 4);
  for (int i = 0; i < 20000; ++i) {
    LatticeTriangle a, b;
    for (auto* t : {&a, &b})
      for (LatticePoint& p : *t) p = {any(random), any(random), any(random)};
    const bool answer = intersect_beyond_shared(a, b);
    std::rotate(a.begin(), a.begin() + 1, a.end());
    std::ranges::reverse(b);
    ASSERT_EQ(intersect_beyond_shared(b, a), answer);
  }
}

TEST(PairsOfTriangles, NeighboursInAMeshDoNotCut) {
  const LatticePoint a{0, 0, 0}, b{10, 0, 0}, c{0, 10, 0}, d{10, 10, 3}, e{-5, 10, 1};
  const LatticeTriangle abc{a, b, c};
  const auto cuts = [&](LatticePoint p, LatticePoint q, LatticePoint r) {
    return intersect_beyond_shared(abc, {p, q, r});
  };
  EXPECT_FALSE(cuts(c, b, d));
  EXPECT_FALSE(cuts(c, d, e));
  EXPECT_TRUE(cuts(a, b, {3, 3, 0}));                   // folded onto it
  EXPECT_FALSE(cuts(a, b, {3, -3, 0}));                 // flat
  EXPECT_TRUE(cuts({2, 2, -1}, {2, 2, 1}, {9, 9, 0}));  // through it
  EXPECT_TRUE(cuts({2, 2, 0}, {2, 2, 9}, {9, 9, 9}));   // a corner on it
  EXPECT_TRUE(cuts(a, {4, 4, 2}, {4, 4, -2}));          // from a corner
  EXPECT_FALSE(cuts({2, 2, 1}, {2, 2, 9}, {9, 9, 9}));  // above it
}

}  // namespace
}  // namespace voxweld
