#include "tests/support/reference_dual.h"

#include <algorithm>

namespace voxweld::testing {
namespace {

bool corner_inside(unsigned signs, int corner) {
  return (signs >> corner & 1) != 0;
}

bool crosses(unsigned signs, int edge) {
  const CellEdge e = cell_edge(edge);
  return corner_inside(signs, e.low) != corner_inside(signs, e.high);
}

bool on_face(int corner, int face) {
  return (corner >> (face / 2) & 1) == face % 2;
}

std::vector<int> crossings_on(unsigned signs, int face) {
  std::vector<int> result;
  for (int edge = 0; edge < 12; ++edge) {
    const CellEdge e = cell_edge(edge);
    if (on_face(e.low, face) && on_face(e.high, face) && crosses(signs, edge))
      result.push_back(edge);
  }
  return result;
}

// The pairs of crossings that arcs of the face connect.
std::vector<std::vector<int>> arcs_on(unsigned signs, int face, bool joined) {
  const std::vector<int> crossings = crossings_on(signs, face);
  if (crossings.size() == 2) return {crossings};
  std::vector<std::vector<int>> arcs;
  if (crossings.empty()) return arcs;
  for (int corner = 0; corner < 8; ++corner) {
    if (!on_face(corner, face) || corner_inside(signs, corner) == joined) continue;
    std::vector<int> arc;
    for (const int edge : crossings)
      if (cell_edge(edge).low == corner || cell_edge(edge).high == corner) arc.push_back(edge);
    arcs.push_back(arc);
  }
  return arcs;
}

unsigned signs_of_cell(const SignGrid& grid, Index3 cell) {
  unsigned signs = 0;
  for (int c = 0; c < 8; ++c)
    if (grid.inside(cell + Index3{c & 1, c >> 1 & 1, c >> 2})) signs |= 1u << c;
  return signs;
}

Index3 across(Index3 cell, int face) {
  cell[face / 2] += face % 2 == 1 ? 1 : -1;
  return cell;
}

// The faces of the cell where the neighbour is a problem cell too, for the same face.
std::set<int> joined_faces(const SignGrid& grid, Index3 cell) {
  std::set<int> joined;
  for (const int face : problem_faces(signs_of_cell(grid, cell))) {
    const int opposite = face ^ 1;  // the same face, seen from the other cell
    if (problem_faces(signs_of_cell(grid, across(cell, face))).contains(opposite))
      joined.insert(face);
  }
  return joined;
}

CellIndex index_of(Index3 cell) {
  return {cell.z, cell.y, cell.x};
}

// The quad around the edge from lattice point `low` along `axis`, whose low end is inside or not.
DualQuad quad_around(const ReferenceDual& dual, Index3 low, int axis, bool low_inside) {
  const int b = (axis + 1) % 3, c = (axis + 2) % 3;
  // Counter-clockwise about +axis: that is outwards when the low end is inside.
  constexpr std::array<std::array<int, 2>, 4> around = {{{1, 1}, {0, 1}, {0, 0}, {1, 0}}};
  DualQuad quad;
  for (std::size_t i = 0; i < 4; ++i) {
    Index3 cell = low;
    cell[b] -= around[i][0];
    cell[c] -= around[i][1];
    const int corner = around[i][0] << b | around[i][1] << c;
    int edge = 0;
    while (cell_edge(edge).axis != axis || cell_edge(edge).low != corner) ++edge;
    const auto& patches = dual.cells.at(index_of(cell));
    int patch = 0;
    while (!patches[static_cast<std::size_t>(patch)].contains(edge)) ++patch;
    quad[i] = {index_of(cell), patch};
  }
  if (!low_inside) std::reverse(quad.begin(), quad.end());
  return quad;
}

}  // namespace

CellEdge cell_edge(int edge) {
  const int axis = edge / 4, lower = axis == 0 ? 1 : 0, higher = axis == 2 ? 1 : 2;
  const int low = (edge & 1) << lower | (edge >> 1 & 1) << higher;
  return {axis, low, low | 1 << axis};
}

std::vector<Patch> patches_of(unsigned signs, const std::set<int>& joined) {
  std::vector<Patch> patches;
  for (int edge = 0; edge < 12; ++edge)
    if (crosses(signs, edge)) patches.push_back({edge});
  for (int face = 0; face < 6; ++face)
    for (const std::vector<int>& arc : arcs_on(signs, face, joined.contains(face))) {
      const auto holding = [&](int edge) {
        return std::find_if(patches.begin(), patches.end(),
                            [edge](const Patch& p) { return p.contains(edge); });
      };
      const auto a = holding(arc[0]), b = holding(arc[1]);
      if (a == b) continue;
      a->insert(b->begin(), b->end());
      patches.erase(b);
    }
  std::sort(patches.begin(), patches.end());  // sets compare by lowest element first
  return patches;
}

std::set<int> ambiguous_faces(unsigned signs) {
  std::set<int> faces;
  for (int face = 0; face < 6; ++face)
    if (crossings_on(signs, face).size() == 4) faces.insert(face);
  return faces;
}

std::set<int> problem_faces(unsigned signs) {
  std::set<int> faces;
  const std::vector<Patch> patches = patches_of(signs);
  for (const int face : ambiguous_faces(signs)) {
    const std::vector<int> edges = crossings_on(signs, face);
    for (const Patch& patch : patches)
      if (std::includes(patch.begin(), patch.end(), edges.begin(), edges.end())) faces.insert(face);
  }
  return faces;
}

ReferenceDual reference_dual(const SignGrid& grid, AmbiguousFaces rule) {
  ReferenceDual dual;
  each_index(grid.cells().hi, [&](Index3 cell) {
    const unsigned signs = signs_of_cell(grid, cell);
    if (signs == 0 || signs == 255) return;
    const std::set<int> joined =
        rule == AmbiguousFaces::wenger ? joined_faces(grid, cell) : std::set<int>{};
    dual.cells[index_of(cell)] = patches_of(signs, joined);
  });
  each_index(grid.cells().hi, [&](Index3 low) {
    for (int axis = 0; axis < 3; ++axis) {
      Index3 high = low;
      ++high[axis];
      const bool inside = grid.inside(low);
      if (inside != grid.inside(high)) dual.quads.push_back(quad_around(dual, low, axis, inside));
    }
  });
  return dual;
}

std::size_t ReferenceDual::vertices() const {
  std::size_t count = 0;
  for (const auto& [cell, patches] : cells) count += patches.size();
  return count;
}

std::vector<Triangle> ReferenceDual::triangles() const {
  std::map<DualCorner, std::uint32_t> number;
  for (const auto& [cell, patches] : cells)
    for (std::size_t p = 0; p < patches.size(); ++p)
      number.emplace(DualCorner{cell, static_cast<int>(p)},
                     static_cast<std::uint32_t>(number.size()));
  std::vector<Triangle> result;
  for (const DualQuad& q : quads) {
    const std::array n = {number.at(q[0]), number.at(q[1]), number.at(q[2]), number.at(q[3])};
    result.push_back({n[0], n[1], n[2]});
    result.push_back({n[0], n[2], n[3]});
  }
  return result;
}

}  // namespace voxweld::testing
