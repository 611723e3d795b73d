// The tree finds what asking for every pair finds.
#include "stages/exact/intersections.h"

#include <gtest/gtest.h>

#include <random>
#include <set>

namespace voxweld {
namespace {

struct Soup {
  std::vector<LatticePoint> positions;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  TriangleList list() const { return {positions, triangles}; }
};

// Triangles of all sizes, some with corners in common.
Soup make_soup(std::uint64_t seed, std::size_t count) {
  std::mt19937_64 random(seed);
  std::uniform_int_distribution<std::int32_t> place(0, 4000);
  Soup soup;
  for (std::size_t i = 0; i < count; ++i) {
    const std::int32_t size = 4 << (i % 9);
    std::uniform_int_distribution<std::int32_t> near(0, size);
    const LatticePoint at{place(random), place(random), place(random)};
    std::array<std::uint32_t, 3> triangle{};
    for (std::uint32_t& corner : triangle) {
      corner = static_cast<std::uint32_t>(soup.positions.size());
      soup.positions.push_back({at[0] + near(random), at[1] + near(random), at[2] + near(random)});
    }
    if (i % 4 == 1) triangle[0] = soup.triangles.back()[2];
    soup.triangles.push_back(triangle);
  }
  return soup;
}

using PairSet = std::set<std::pair<std::uint32_t, std::uint32_t>>;

TEST(Intersections, AreThoseOfAllPairs) {
  const Soup soup = make_soup(1, 1500);
  PairSet expected, found;
  const TriangleList list = soup.list();
  for (std::uint32_t i = 0; i < list.size(); ++i)
    for (std::uint32_t j = i + 1; j < list.size(); ++j)
      if (intersect_beyond_shared(list[i], list[j])) expected.emplace(i, j);
  std::uint32_t last = 0;
  each_intersection(list, [&](std::uint32_t i, std::uint32_t j) {
    EXPECT_GE(i, last);
    last = i;
    EXPECT_TRUE(found.emplace(i, j).second);
  });
  EXPECT_EQ(found, expected);
  EXPECT_GT(expected.size(), 50U);
}

TEST(Intersections, WithOthersAreThoseOfAllPairs) {
  const Soup one = make_soup(2, 900), two = make_soup(3, 900);
  std::vector<LatticeTriangle> others;
  for (std::size_t j = 0; j < two.list().size(); ++j) others.push_back(two.list()[j]);
  const BoxTree tree(boxes_of(two.list()));
  PairSet expected, found;
  for (std::uint32_t i = 0; i < one.list().size(); ++i)
    for (std::uint32_t j = 0; j < others.size(); ++j)
      if (intersect_beyond_shared(one.list()[i], others[j])) expected.emplace(i, j);
  each_intersection(one.list(), {others, tree}, [&](std::uint32_t i, std::uint32_t j) {
    EXPECT_TRUE(found.emplace(i, j).second);
  });
  EXPECT_EQ(found, expected);
  EXPECT_GT(expected.size(), 50U);
}

TEST(Intersections, OfNothingAreNone) {
  each_intersection(TriangleList{}, [](std::uint32_t, std::uint32_t) { FAIL(); });
  each_intersection(TriangleList{}, {{}, BoxTree({})},
                    [](std::uint32_t, std::uint32_t) { FAIL(); });
}

}  // namespace
}  // namespace voxweld
