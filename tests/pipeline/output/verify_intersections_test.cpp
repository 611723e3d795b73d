// Intersecting triangles are counted whatever tiles they are in.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stages/exact/intersections.h"
#include "tests/pipeline/output/output_directory.h"

namespace voxweld {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using testing::OutputDirectory;
using testing::verified;

// Its tube is wider than its ring: it goes through itself.
TileMesh spindle() {
  return testing::make_torus({.around = 48, .across = 24, .radius = 5, .tube = 9},
                             testing::small_lattice());
}

std::uint64_t pairs_of(const TileMesh& mesh) {
  std::uint64_t pairs = 0;
  each_intersection({mesh.positions, mesh.triangles},
                    [&](std::uint32_t, std::uint32_t) { ++pairs; });
  return pairs;
}

OutputDirectory in_tiles(const TileMesh& mesh, int level) {
  OutputDirectory output;
  output.tiles = testing::cut_into_tiles(mesh, level);
  output.merged = output.glb = false;
  return output;
}

TEST(VerifyIntersections, AreThoseOfTheWholeWhateverTheTiles) {
  const TileMesh mesh = spindle();
  const std::uint64_t expected = pairs_of(mesh);
  ASSERT_GT(expected, 100U);
  for (const int level : {0, 1, 2, 3, 6})
    for (const int threads : {1, 4}) {
      const VerifyReport report =
          verified(in_tiles(mesh, level), {.threads = threads, .intersections = true});
      ASSERT_TRUE(report.intersections);
      EXPECT_EQ(report.intersections->pairs, expected) << level;
      EXPECT_EQ(report.intersections->degenerate, 0U);
      EXPECT_EQ(report.intersections->first.size(), IntersectionCount::most_places);
      EXPECT_TRUE(report.good()) << to_text(report);
    }
}

TEST(VerifyIntersections, AreToldWhereTheyAre) {
  const VerifyReport report = verified(in_tiles(spindle(), 3), {.intersections = true});
  for (const Vec3& p : report.intersections->first) {
    EXPECT_NEAR(p.x, 20, 14.1);
    EXPECT_NEAR(p.z, 20, 9.1);
  }
  EXPECT_THAT(to_text(report), HasSubstr(fmt::format("{} pairs of triangles intersect, 0 triangles "
                                                     "without an area\n  at (",
                                                     report.intersections->pairs)));
  EXPECT_THAT(to_json_text(report),
              HasSubstr(fmt::format("\"intersecting_pairs\":{},\"degenerate_triangles\":0",
                                    report.intersections->pairs)));
}

TEST(VerifyIntersections, AreCountedOnlyWhereAskedFor) {
  const VerifyReport report = verified(in_tiles(spindle(), 3), {});
  EXPECT_FALSE(report.intersections);
  EXPECT_THAT(to_text(report), Not(HasSubstr("intersect")));
  EXPECT_THAT(to_json_text(report), Not(HasSubstr("intersect")));
}

TEST(VerifyIntersections, ASoundTorusHasNone) {
  const TileMesh torus =
      testing::make_torus({.around = 48, .across = 24}, testing::small_lattice());
  for (const int level : {1, 3, 6}) {
    const VerifyReport report = verified(in_tiles(torus, level), {.intersections = true});
    EXPECT_EQ(report.intersections->pairs, 0U);
    EXPECT_THAT(to_text(report), HasSubstr("0 pairs of triangles intersect"));
  }
}

// Bodies of two labels may lie in each other: that is not counted.
TEST(VerifyIntersections, OfLabelsAreThoseWithinEach) {
  const TileMesh mesh = spindle();
  OutputDirectory output = in_tiles(mesh, 3);
  output.labels.assign(output.tiles.size(), 3);
  output.tiles.push_back(testing::make_cube(testing::small_lattice(), {16, 16, 16}, 8, 2));
  output.tiles.back().tile = {6, {}};
  output.labels.push_back(5);
  const VerifyReport report = verified(output, {.intersections = true});
  EXPECT_TRUE(report.good()) << to_text(report);
  EXPECT_EQ(report.intersections->pairs, pairs_of(mesh));
}

TEST(VerifyIntersections, TrianglesWithoutAnAreaAreCountedApart) {
  TileMesh mesh = testing::make_cube(testing::small_lattice(), {4, 4, 4}, 8, 2);
  // The cube's edges have a vertex in the middle: one triangle along such an edge is flat.
  auto& p = mesh.positions;
  const auto& t = mesh.triangles.front();
  p[t[0]] = {p[t[1]][0] + (p[t[1]][0] - p[t[2]][0]), p[t[1]][1] + (p[t[1]][1] - p[t[2]][1]),
             p[t[1]][2] + (p[t[1]][2] - p[t[2]][2])};
  const VerifyReport report = verified(in_tiles(mesh, 6), {.intersections = true});
  EXPECT_GE(report.intersections->degenerate, 1U);
  EXPECT_EQ(report.intersections->pairs, pairs_of(mesh));
}

}  // namespace
}  // namespace voxweld
