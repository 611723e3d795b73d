#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

#include "tests/stages/shape_tree.h"

namespace voxweld {
namespace {

using testing::DualCorner;
using testing::DualQuad;
using testing::ReferenceDual;
using testing::ShapeNode;
using testing::ShapeTree;
using testing::volume;

// Which clusters that may become vertices do.
using Wanted = std::function<bool(const ShapeNode&, std::size_t)>;

// Each sheet in the highest of its clusters that becomes a vertex.
std::map<DualCorner, std::uint32_t> vertices_of(const testing::SignGrid& grid,
                                                const ReferenceDual& dual,
                                                const ClusterRules& rules, const Wanted& wanted) {
  std::map<DualCorner, std::uint32_t> vertex;
  std::uint32_t next = 0;
  for (const auto& [cell, patches] : dual.cells)
    for (std::size_t p = 0; p < patches.size(); ++p) vertex[{cell, static_cast<int>(p)}] = next++;
  ShapeTree(grid, dual, rules).each(root_of(grid), [&](const ShapeNode& node) {
    for (std::size_t c = 0; c < node.clusters.size(); ++c) {
      if (!node.allowed[c] || !wanted(node, c)) continue;
      for (const DualCorner& sheet : node.clusters[c]) vertex[sheet] = next;
      ++next;
    }
  });
  return vertex;
}

std::vector<testing::Triangle> mesh_of(const ReferenceDual& dual,
                                       const std::map<DualCorner, std::uint32_t>& vertex) {
  std::vector<testing::Triangle> triangles;
  for (const DualQuad& quad : dual.quads) {
    std::vector<std::uint32_t> corners;
    for (std::size_t k = 0; k < 4; ++k)
      if (vertex.at(quad[k]) != vertex.at(quad[(k + 3) % 4])) corners.push_back(vertex.at(quad[k]));
    // Quads are cut as their vertices say, whichever edge they stand for: two quads of the same four
    // vertices are cut alike, and are no manifold then.
    std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
    for (std::size_t k = 1; k + 1 < corners.size(); ++k)
      triangles.push_back({corners[0], corners[k], corners[k + 1]});
  }
  return triangles;
}

// Euler number of each component of the surface, by its first sheet.
std::map<DualCorner, std::int64_t> euler_numbers(
    const ReferenceDual& dual, const std::map<DualCorner, std::uint32_t>& vertex) {
  std::map<DualCorner, DualCorner> parent;
  for (const auto& [sheet, v] : vertex) parent[sheet] = sheet;
  const auto root = [&](DualCorner sheet) {
    while (parent.at(sheet) != sheet) sheet = parent.at(sheet);
    return sheet;
  };
  for (const DualQuad& quad : dual.quads)
    for (std::size_t k = 1; k < 4; ++k) {
      const DualCorner a = root(quad[0]), b = root(quad[k]);
      if (a != b) parent[std::max(a, b)] = std::min(a, b);
    }
  std::map<DualCorner, std::vector<testing::Triangle>> parts;
  for (const DualQuad& quad : dual.quads) {
    ReferenceDual one;
    one.quads = {quad};
    std::vector<testing::Triangle>& part = parts[root(quad[0])];
    for (const testing::Triangle& triangle : mesh_of(one, vertex)) part.push_back(triangle);
  }
  std::map<DualCorner, std::int64_t> euler;
  for (const auto& [first, triangles] : parts)
    euler[first] = testing::euler_characteristic(triangles);
  return euler;
}

struct Outcome {
  std::size_t triangles = 0, defects = 0, changed = 0;  // components of another Euler number
};

Outcome collapse(unsigned seed, std::int64_t side, const ClusterRules& rules, double share) {
  const testing::SignGrid grid = volume(seed, side);
  const ReferenceDual dual = testing::reference_dual(grid);
  const auto fine =
      vertices_of(grid, dual, rules, [](const ShapeNode&, std::size_t) { return false; });
  std::mt19937 random(seed);
  const auto vertex = vertices_of(grid, dual, rules, [&](const ShapeNode&, std::size_t) {
    return static_cast<double>(random() % 1000) < share * 1000;
  });
  const auto triangles = mesh_of(dual, vertex);
  const testing::MeshSummary summary = testing::summarize(triangles);
  Outcome outcome{triangles.size(),
                  summary.boundary_edges + summary.duplicated_edges + summary.nonmanifold_vertices +
                      summary.degenerate_triangles,
                  0};
  const auto before = euler_numbers(dual, fine), after = euler_numbers(dual, vertex);
  for (const auto& [first, euler] : before) outcome.changed += after.at(first) != euler ? 1 : 0;
  return outcome;
}

// 1: all that may, as at an infinite tolerance; else some at random.
constexpr std::array<double, 3> shares = {1.0, 0.5, 0.1};

TEST(ClusterRules, WhateverCollapsesTheMeshStaysAManifoldOfTheSameTopology) {
  std::size_t all = 0;
  for (unsigned seed = 0; seed < 24; ++seed)
    for (const double share : shares) {
      const Outcome outcome = collapse(seed, 16, {}, share);
      EXPECT_EQ(outcome.defects, 0u) << "seed " << seed << ", share " << share;
      EXPECT_EQ(outcome.changed, 0u) << "seed " << seed << ", share " << share;
      all += outcome.triangles;
    }
  EXPECT_GT(all, 10000u);
}

// Without it something comes out wrong.
void expect_needed(const ClusterRules& rules) {
  std::size_t wrong = 0;
  for (unsigned seed = 0; seed < 24; ++seed) {
    const Outcome outcome = collapse(seed, 16, rules, 1);
    wrong += outcome.defects + outcome.changed;
  }
  EXPECT_GT(wrong, 0u);
}
TEST(ClusterRules, RuleOneIsNeeded) {
  expect_needed({.disc = false});
}
TEST(ClusterRules, RuleTwoIsNeeded) {
  expect_needed({.edge_once = false});
}
TEST(ClusterRules, RuleThreeIsNeeded) {
  expect_needed({.face_twice = false});
}
TEST(ClusterRules, RuleThreeIsNeededForClustersWithoutACrossedEdge) {
  expect_needed({.some_edge = false});
}
TEST(ClusterRules, RuleFourIsNeeded) {
  expect_needed({.one_arc_a_face = false});
}

}  // namespace
}  // namespace voxweld
