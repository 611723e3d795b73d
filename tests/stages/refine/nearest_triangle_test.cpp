// Eight points at once against one after the other.
#include "stages/refine/nearest_triangle.h"

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>
#include <vector>

#include "plain_nearest.h"
#include "random_places.h"
#include "tests/stages/with_all_kernels.h"

namespace voxweld {
namespace {

using testing::RandomPlaces;
using testing::with_all_kernels;

void expect_nearest(const NearestLanes& found, std::size_t lane, const testing::Nearest& plain) {
  EXPECT_EQ(std::bit_cast<std::uint64_t>(found.squared[lane]),
            std::bit_cast<std::uint64_t>(plain.squared));
  EXPECT_EQ(found.triangle[lane], static_cast<double>(plain.triangle));
}

// Of few coordinates, so that many are equally near and points lie on corners and edges; and of as many
// as there are.
TEST(NearestTriangles, SayWhatAllOfThemSay) {
  with_all_kernels([] {
    RandomPlaces random;
    for (int round = 0; round < 600; ++round) {
      constexpr std::array<std::int32_t, 3> extents = {6, 30000, 1 << 26};
      const std::int32_t extent = extents[static_cast<std::size_t>(round) % extents.size()];
      NearestTriangles nearest;
      std::vector<LatticeTriangle> shapes;
      const auto count = static_cast<std::size_t>(random(1, 13));
      while (shapes.size() < count) {
        shapes.push_back(random.triangle(0, extent));
        nearest.add(shapes.back(), {});
      }
      for (int k = 0; k < 3; ++k) {  // with what was asked before still in lanes
        std::vector<LatticePoint> points;
        const auto asked = static_cast<std::size_t>(random(1, lanes));
        while (points.size() < asked) {
          points.push_back(random.point(-extent / 2, extent + extent / 2));
          nearest.ask(points.back(), {});
        }
        EXPECT_EQ(nearest.waiting(), asked);
        EXPECT_EQ(nearest.is_full(), asked == lanes);
        const NearestLanes& found = nearest.answer();
        EXPECT_EQ(nearest.waiting(), 0u);
        for (std::size_t i = 0; i < asked; ++i)
          expect_nearest(found, i, testing::nearest_triangle(points[i], shapes));
      }
    }
  });
}

// Corners, edges and the inside, from above and from outside: what is near is known.
TEST(NearestTriangles, AreNearWithEachOfTheirParts) {
  with_all_kernels([] {
    NearestTriangles nearest;
    nearest.add({{{0, 0, 0}, {10, 0, 0}, {0, 10, 0}}}, {});
    const std::array<std::pair<LatticePoint, double>, lanes> known{{{{-3, -4, 0}, 25},  // corners
                                                                    {{14, -3, 0}, 25},
                                                                    {{-3, 14, 0}, 25},
                                                                    {{5, -2, 1}, 5},  // edges
                                                                    {{-2, 5, 1}, 5},
                                                                    {{6, 6, 0}, 2},
                                                                    {{2, 3, 7}, 49},  // inside
                                                                    {{2, 3, 0}, 0}}};
    for (const auto& [point, squared] : known) nearest.ask(point, {});
    const NearestLanes& found = nearest.answer();
    for (std::size_t i = 0; i < lanes; ++i) EXPECT_DOUBLE_EQ(found.squared[i], known[i].second);
  });
}

TEST(NearestTriangles, AreOfTheSameSides) {
  with_all_kernels([] {
    NearestTriangles nearest;
    nearest.add({{{0, 0, 0}, {9, 0, 0}, {0, 9, 0}}}, {1, 2});
    nearest.add({{{0, 0, 5}, {9, 0, 5}, {0, 9, 5}}}, {1, 3});
    nearest.add({{{0, 0, 4}, {9, 0, 4}, {0, 9, 4}}}, {1, 2});
    nearest.ask({1, 1, 0}, {1, 3});
    nearest.ask({1, 1, 0}, {2, 3});
    nearest.ask({1, 1, 5}, {1, 2});
    const NearestLanes& found = nearest.answer();
    EXPECT_EQ(found.triangle[0], 1);
    EXPECT_EQ(found.squared[0], 25);
    EXPECT_TRUE(std::isinf(found.squared[1]));
    EXPECT_EQ(found.triangle[2], 2);
    EXPECT_EQ(found.squared[2], 1);
    nearest.clear();
    nearest.add({{{0, 0, 5}, {9, 0, 5}, {0, 9, 5}}}, {1, 3});
    nearest.ask({1, 1, 0}, {1, 3});
    EXPECT_EQ(nearest.answer().triangle[0], 0);
  });
}

}  // namespace
}  // namespace voxweld
