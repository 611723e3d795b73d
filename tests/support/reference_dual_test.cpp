#include "tests/support/reference_dual.h"

#include <gtest/gtest.h>

#include <random>

namespace voxweld::testing {
namespace {

SignGrid random_grid(Index3 size, std::uint32_t seed, double share) {
  std::mt19937 random(seed);
  std::bernoulli_distribution inside(share);
  return SignGrid(size, [&](Index3) { return inside(random); });
}

std::vector<Vec3> cell_centres(const ReferenceDual& dual) {
  std::vector<Vec3> centres;
  for (const auto& [cell, patches] : dual.cells)
    centres.insert(
        centres.end(), patches.size(),
        {static_cast<double>(cell.x), static_cast<double>(cell.y), static_cast<double>(cell.z)});
  return centres;
}

TEST(ReferenceDual, NumbersCornersAndEdgesAsDrawn) {
  EXPECT_EQ(cell_edge(0).high, 1);
  EXPECT_EQ(cell_edge(3).low, 6);
  EXPECT_EQ(cell_edge(5).low, 1);
  EXPECT_EQ(cell_edge(6).low, 4);
  EXPECT_EQ(cell_edge(10).low, 2);
  EXPECT_EQ(cell_edge(11).high, 7);
  for (int e = 0; e < 12; ++e) EXPECT_EQ(cell_edge(e).high, cell_edge(e).low ^ 1 << e / 4);
}

TEST(ReferenceDual, PatchesByHand) {
  EXPECT_TRUE(patches_of(0).empty());
  EXPECT_EQ(patches_of(0b00000001), (std::vector<Patch>{{0, 4, 8}}));
  EXPECT_EQ(patches_of(0b00001111), (std::vector<Patch>{{8, 9, 10, 11}}));
  // Two inside corners across a face: cut off each, or joined through the face (z low: face 4).
  EXPECT_EQ(patches_of(0b00001001), (std::vector<Patch>{{0, 4, 8}, {1, 5, 11}}));
  EXPECT_EQ(patches_of(0b00001001, {4}), (std::vector<Patch>{{0, 1, 4, 5, 8, 11}}));
  // Across the cell: no ambiguous face, two patches.
  EXPECT_EQ(patches_of(0b10000001), (std::vector<Patch>{{0, 4, 8}, {3, 7, 11}}));
  // Four inside corners, no two on an edge.
  EXPECT_EQ(patches_of(0b01101001).size(), 4u);
}

TEST(ReferenceDual, ProblemConfigurationsAreThirtySix) {
  int problems = 0;
  for (unsigned signs = 0; signs < 256; ++signs) {
    const auto faces = problem_faces(signs);
    if (faces.empty()) continue;
    ++problems;
    EXPECT_EQ(faces.size(), 1u) << signs;
    EXPECT_EQ(ambiguous_faces(signs), faces) << signs;
    EXPECT_EQ(patches_of(signs).size(), 1u) << signs;
    EXPECT_EQ(patches_of(signs, faces).size(), 2u) << "joined, it falls in two: " << signs;
  }
  EXPECT_EQ(problems, 36);
}

// For each sheet the patch is a closed loop of arcs: every crossing is in exactly one.
TEST(ReferenceDual, PatchesShareOutTheCrossings) {
  for (unsigned signs = 0; signs < 256; ++signs) {
    std::size_t crossings = 0, held = 0;
    for (int e = 0; e < 12; ++e)
      crossings += (signs >> cell_edge(e).low & 1) != (signs >> cell_edge(e).high & 1);
    for (const Patch& patch : patches_of(signs)) {
      EXPECT_GE(patch.size(), 3u);
      held += patch.size();
    }
    EXPECT_EQ(held, crossings);
  }
}

TEST(ReferenceDual, OneSampleIsACube) {
  const SignGrid grid({1, 1, 1}, [](Index3) { return true; });
  const ReferenceDual dual = reference_dual(grid);
  EXPECT_EQ(dual.cells.size(), 8u);
  EXPECT_EQ(dual.quads.size(), 6u);
  EXPECT_EQ(summarize(dual.triangles()), (MeshSummary{.components = 1, .euler = 2}));
  EXPECT_DOUBLE_EQ(signed_volume(cell_centres(dual), dual.triangles()), 1) << "outward";
}

TEST(ReferenceDual, RingOfSamplesIsATorus) {
  const SignGrid grid({3, 3, 1}, [](Index3 p) { return p.x != 1 || p.y != 1; });
  const ReferenceDual dual = reference_dual(grid);
  EXPECT_EQ(summarize(dual.triangles()), (MeshSummary{.components = 1, .euler = 0}));
  EXPECT_DOUBLE_EQ(signed_volume(cell_centres(dual), dual.triangles()), 8);
}

TEST(ReferenceDual, SamplesAcrossAnEdgeStaySeparate) {
  const SignGrid grid({2, 2, 1}, [](Index3 p) { return p.x == p.y; });
  EXPECT_EQ(summarize(reference_dual(grid).triangles()),
            (MeshSummary{.components = 2, .euler = 4}));
}

TEST(ReferenceDual, EveryCrossingGivesOneQuad) {
  const SignGrid grid = random_grid({5, 4, 6}, 1, 0.5);
  EXPECT_EQ(static_cast<std::int64_t>(reference_dual(grid).quads.size()),
            count_crossings(grid).total());
}

// All pairs of cells that share a face, with what lies around them outside.
TEST(ReferenceDual, EveryPairOfCellsIsSoundByTheRuleAloneNot) {
  int bad_without = 0;
  for (unsigned bits = 0; bits < 4096; ++bits) {
    const SignGrid grid(
        {3, 2, 2}, [bits](Index3 p) { return (bits >> ((p.z * 2 + p.y) * 3 + p.x) & 1) != 0; });
    const MeshSummary with = summarize(reference_dual(grid).triangles());
    EXPECT_TRUE(with.sound()) << bits << ": " << with;
    bad_without += !summarize(reference_dual(grid, AmbiguousFaces::separate).triangles()).sound();
  }
  EXPECT_EQ(bad_without, 18);
}

TEST(ReferenceDual, RandomVolumesAreSound) {
  int bad_without = 0;
  for (std::uint32_t seed = 0; seed < 60; ++seed) {
    const double share = 0.3 + 0.1 * (seed % 5);
    const SignGrid grid = random_grid({7, 6, 8}, seed, share);
    const MeshSummary with = summarize(reference_dual(grid).triangles());
    EXPECT_TRUE(with.sound()) << "seed " << seed << ": " << with;
    bad_without += !summarize(reference_dual(grid, AmbiguousFaces::separate).triangles()).sound();
  }
  EXPECT_GT(bad_without, 0) << "the rule has something to do";
}

}  // namespace
}  // namespace voxweld::testing
