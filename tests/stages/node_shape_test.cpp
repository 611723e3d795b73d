#include "stages/contouring/node_shape.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numeric>
#include <random>
#include <set>

#include "tests/support/reference_dual.h"

namespace voxweld {
namespace {

using testing::CellIndex;
using testing::DualCorner;
using testing::DualQuad;
using testing::ReferenceDual;
using Sheets = std::set<DualCorner>;

Index3 at(const DualCorner& sheet) {
  return {sheet.cell.x, sheet.cell.y, sheet.cell.z};
}
bool holds(CellKey node, const DualCorner& sheet) {
  return node.cells().contains(at(sheet));
}

// ------------------------------------------------------------------ volumes

testing::SignGrid noise(std::int64_t side, unsigned seed, double share) {
  std::mt19937 random(seed);
  std::map<CellIndex, bool> inside;
  each_index(splat(side), [&](Index3 p) {
    inside[{p.z, p.y, p.x}] = static_cast<double>(random() % 1000) < share * 1000;
  });
  return {splat(side), [&](Index3 p) { return inside.at({p.z, p.y, p.x}); }};
}

testing::SignGrid smooth(std::int64_t side, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(-1, 1);
  struct Wave {
    Vec3 way;
    double phase = 0, height = 0;
  };
  std::vector<Wave> waves(12);
  for (Wave& wave : waves)
    wave = {Vec3{unit(random), unit(random), unit(random)}, 3 * unit(random), unit(random)};
  return {
      splat(side), [&](Index3 p) {
        const Vec3 v{static_cast<double>(p.x), static_cast<double>(p.y), static_cast<double>(p.z)};
        double sum = 0;
        for (const Wave& wave : waves) sum += wave.height * std::cos(dot(wave.way, v) + wave.phase);
        return sum > 0;
      }};
}

// A third of each: noise, sparse noise, smooth fields.
testing::SignGrid volume(unsigned seed, std::int64_t side) {
  if (seed % 3 == 0) return noise(side, seed, 0.5);
  if (seed % 3 == 1) return noise(side, seed, 0.15);
  return smooth(side, seed);
}

// ------------------------------------------------------------------ clusters by definition

struct PlainCluster {
  Sheets sheets;
  bool allowed = false;
  friend auto operator<=>(const PlainCluster&, const PlainCluster&) = default;
};

// What is looked at of the whole surface.
struct PlainSurface {
  explicit PlainSurface(const testing::SignGrid& grid) : dual(testing::reference_dual(grid)) {
    for (const DualQuad& quad : dual.quads)
      for (std::size_t k = 0; k < 4; ++k) {
        const DualCorner a = quad[k], b = quad[(k + 1) % 4];
        arcs[a].insert(b);
        arcs[b].insert(a);
      }
  }
  ReferenceDual dual;
  std::map<DualCorner, Sheets> arcs;  // sheets joined by an arc: two never by more than one
};

std::vector<Sheets> components(const PlainSurface& surface, CellKey node, Sheets rest) {
  std::vector<Sheets> all;
  while (!rest.empty()) {
    Sheets found, front{*rest.begin()};
    while (!front.empty()) {
      const DualCorner sheet = *front.begin();
      front.erase(front.begin());
      found.insert(sheet);
      for (const DualCorner& next : surface.arcs.at(sheet))
        if (holds(node, next) && !found.contains(next)) front.insert(next);
    }
    for (const DualCorner& sheet : found) rest.erase(sheet);
    all.push_back(found);
  }
  return all;
}

// The rules, by counting.
bool allowed(const PlainSurface& surface, const std::vector<DualQuad>& quads, CellKey node,
             const Sheets& sheets) {
  std::int64_t arcs = 0, crossings = 0;
  std::map<std::array<std::int64_t, 6>, Sheets> faces;  // finest ones on the border: what is behind
  for (const DualCorner& sheet : sheets)
    for (const DualCorner& next : surface.arcs.at(sheet)) {
      if (holds(node, next))
        ++arcs;
      else
        faces[{at(sheet).x, at(sheet).y, at(sheet).z, at(next).x, at(next).y, at(next).z}].insert(
            next);
    }
  std::map<std::array<int, 3>, int> on_edges;  // by side on each axis: 0 along, -1 or 1
  for (const DualQuad& quad : quads) {
    int within = 0;
    Index3 way;
    bool here = false;
    for (const DualCorner& corner : quad) {
      if (!holds(node, corner)) continue;
      ++within;
      here = here || sheets.contains(corner);
    }
    if (!here) continue;
    if (within == 4) ++crossings;
    if (within != 1) continue;
    for (const DualCorner& corner : quad)
      for (int a = 0; a < 3; ++a) {
        if (at(corner)[a] < node.cells().lo[a]) way[a] = -1;
        if (at(corner)[a] >= node.cells().hi[a]) way[a] = 1;
      }
    ++on_edges[{static_cast<int>(way.x), static_cast<int>(way.y), static_cast<int>(way.z)}];
  }
  if (static_cast<std::int64_t>(sheets.size()) - arcs / 2 + crossings != 1) return false;
  if (on_edges.empty()) return false;
  std::map<std::pair<std::size_t, int>, int> on_faces;
  for (const auto& [edge, count] : on_edges) {
    if (count > 1) return false;
    for (std::size_t a = 0; a < 3; ++a)
      if (edge[a] != 0) ++on_faces[{a, edge[a]}];
  }
  for (const auto& [face, count] : on_faces)
    if (count != 2) return false;
  // Two arcs on one finest face. They may lead to one sheet on the other side or to two, and come
  // from one here or from two: so four corners around the face, two crossings an arc.
  std::map<std::pair<CellIndex, CellIndex>, std::set<std::pair<DualCorner, DualCorner>>> border;
  for (const DualCorner& sheet : sheets)
    for (const DualCorner& next : surface.arcs.at(sheet))
      if (!holds(node, next)) border[{sheet.cell, next.cell}].insert({sheet, next});
  return std::all_of(border.begin(), border.end(),
                     [](const auto& face) { return face.second.size() == 1; });
}

std::set<PlainCluster> plain_clusters(const PlainSurface& surface, CellKey node,
                                      const Sheets& sheets) {
  std::vector<DualQuad> quads;
  for (const DualQuad& quad : surface.dual.quads)
    if (std::any_of(quad.begin(), quad.end(), [&](const auto& c) { return sheets.contains(c); }))
      quads.push_back(quad);
  std::set<PlainCluster> clusters;
  for (const Sheets& found : components(surface, node, sheets)) {
    const bool open = std::any_of(found.begin(), found.end(), [&](const DualCorner& sheet) {
      const Sheets& next = surface.arcs.at(sheet);
      return std::any_of(next.begin(), next.end(), [&](const auto& n) { return !holds(node, n); });
    });
    if (open) clusters.insert({found, allowed(surface, quads, node, found)});
  }
  return clusters;
}

// ------------------------------------------------------------------ clusters by shapes

struct ShapeNode {
  CellKey key;
  std::vector<std::int32_t> euler;
  std::vector<FaceCurve> curves;
  std::vector<CurvePair> pairs;
  std::vector<Sheets> clusters;  // that are open
  std::vector<bool> allowed;
  NodeShape shape() const { return {euler, curves, pairs}; }
};

// All nodes of a volume from the cells up; f takes each when its children were taken.
class ShapeTree {
 public:
  ShapeTree(const testing::SignGrid& grid, const ReferenceDual& dual, const ClusterRules& rules)
      : grid_(grid), dual_(dual), rules_(rules) {}

  template <class F>
  void each(CellKey root, const F& f) {
    node(root, f);
  }

 private:
  CellSigns signs_of(Index3 cell) const {
    unsigned signs = 0;
    for (int corner = 0; corner < 8; ++corner)
      signs |= static_cast<unsigned>(
                   grid_.inside(cell + Index3{corner & 1, corner >> 1 & 1, corner >> 2}))
               << corner;
    return static_cast<CellSigns>(signs);
  }
  bool joined(Index3 cell) const {
    const int face = problem_face(signs_of(cell));
    if (face < 0) return false;
    Index3 across = cell;
    across[face >> 1] += (face & 1) != 0 ? 1 : -1;
    return joins_across(signs_of(cell), face, signs_of(across));
  }

  template <class F>
  std::vector<Sheets> node(CellKey key, const F& f, ShapeNode* out = nullptr) {
    if (intersect(key.cells(), grid_.cells()).empty()) return {};
    std::array<ShapeNode, 8> children;
    std::vector<Sheets> below;
    ShapeMerger merger(rules_);
    merger.begin(key);
    for (int o = 0; o < 8; ++o) {
      const CellKey child = key.child(o);
      if (child.level == 0) {
        const auto found = dual_.cells.find({child.at.z, child.at.y, child.at.x});
        if (found == dual_.cells.end()) continue;
        merger.add_cell(o, signs_of(child.at), joined(child.at));
        for (std::size_t p = 0; p < found->second.size(); ++p)
          below.push_back({{found->first, static_cast<int>(p)}});
        continue;
      }
      ShapeNode& made = children[static_cast<std::size_t>(o)];
      node(child, f, &made);
      if (made.curves.empty()) continue;
      merger.add(o, made.shape());
      below.insert(below.end(), made.clusters.begin(), made.clusters.end());
    }
    if (below.empty()) return {};
    merger.merge();
    ShapeNode mine;
    mine.key = key;
    const NodeShape shape = merger.shape();
    mine.euler.assign(shape.euler.begin(), shape.euler.end());
    mine.curves.assign(shape.curves.begin(), shape.curves.end());
    mine.pairs.assign(shape.pairs.begin(), shape.pairs.end());
    mine.clusters.resize(shape.euler.size());
    for (std::size_t i = 0; i < below.size(); ++i) {
      const std::uint32_t cluster = merger.cluster_of()[i];
      if (cluster != no_cluster) mine.clusters[cluster].insert(below[i].begin(), below[i].end());
    }
    for (std::size_t c = 0; c < mine.clusters.size(); ++c)
      mine.allowed.push_back(merger.may_collapse(c));
    f(mine);
    if (out != nullptr) *out = std::move(mine);
    return {};
  }

  const testing::SignGrid& grid_;
  const ReferenceDual& dual_;
  ClusterRules rules_;
};

CellKey root_of(const testing::SignGrid& grid) {
  return {domain_level(grid.size()), {}};
}

TEST(NodeShape, ClustersAndTheirRulesAreThoseCountedCellByCell) {
  for (unsigned seed = 0; seed < 9; ++seed) {
    const testing::SignGrid grid = volume(seed, 13);
    const PlainSurface surface(grid);
    int nodes = 0, may = 0;
    ShapeTree(grid, surface.dual, {}).each(root_of(grid), [&](const ShapeNode& node) {
      Sheets sheets;
      for (const auto& [cell, patches] : surface.dual.cells)
        for (std::size_t p = 0; p < patches.size(); ++p)
          if (const DualCorner sheet{cell, static_cast<int>(p)}; holds(node.key, sheet))
            sheets.insert(sheet);
      std::set<PlainCluster> found;
      for (std::size_t c = 0; c < node.clusters.size(); ++c)
        found.insert({node.clusters[c], node.allowed[c]});
      ASSERT_EQ(found, plain_clusters(surface, node.key, sheets))
          << "seed " << seed << ", level " << node.key.level;
      ++nodes;
      may += static_cast<int>(std::count(node.allowed.begin(), node.allowed.end(), true));
    });
    EXPECT_GT(nodes, 100);
    EXPECT_GT(may, 10) << seed;
  }
}

// ------------------------------------------------------------------ meshes of collapsed clusters

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

TEST(NodeShape, WhateverCollapsesTheMeshStaysAManifoldOfTheSameTopology) {
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
TEST(NodeShape, RuleOneIsNeeded) {
  expect_needed({.disc = false});
}
TEST(NodeShape, RuleTwoIsNeeded) {
  expect_needed({.edge_once = false});
}
TEST(NodeShape, RuleThreeIsNeeded) {
  expect_needed({.face_twice = false});
}
TEST(NodeShape, RuleThreeIsNeededForClustersWithoutACrossedEdge) {
  expect_needed({.some_edge = false});
}
TEST(NodeShape, RuleFourIsNeeded) {
  expect_needed({.one_arc_a_face = false});
}

}  // namespace
}  // namespace voxweld
