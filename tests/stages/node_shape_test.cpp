#include "stages/contouring/node_shape.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/stages/shape_tree.h"

namespace voxweld {
namespace {

using testing::CellIndex;
using testing::DualCorner;
using testing::DualQuad;
using testing::holds;
using testing::ReferenceDual;
using testing::ShapeNode;
using testing::ShapeTree;
using testing::Sheets;
using testing::volume;

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

}  // namespace
}  // namespace voxweld
