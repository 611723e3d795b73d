// What telling the sheets of a cell by signs and by labels has in common.
#pragma once

#include <algorithm>

#include "stages/contouring/cell_topology.h"

namespace voxweld {

// Sets of a cell's edges, each named by its lowest.
class CrossingSets {
 public:
  constexpr CrossingSets() {
    for (std::size_t i = 0; i < 12; ++i) parent_[i] = static_cast<std::uint8_t>(i);
  }
  constexpr std::size_t root(int edge) const {
    auto i = static_cast<std::size_t>(edge);
    while (parent_[i] != i) i = parent_[i];
    return i;
  }
  constexpr void join(int a, int b) {
    const std::size_t ra = root(a), rb = root(b);
    parent_[std::max(ra, rb)] = static_cast<std::uint8_t>(std::min(ra, rb));
  }
  // An arc around corner c[i] of a face with these corners.
  constexpr void join_around(const std::array<int, 4>& c, std::size_t i) {
    join(edge_between(c[i], c[(i + 1) % 4]), edge_between(c[i], c[(i + 3) % 4]));
  }

  // A sheet for each set of the edges for which crosses(edge), numbered by its lowest.
  template <class Crosses>
  constexpr CellSheets sheets(const Crosses& crosses) const {
    CellSheets cell;
    cell.sheet_of_edge.fill(255);
    for (int e = 0; e < 12; ++e) {
      if (!crosses(e)) continue;
      cell.edges[cell.crossings++] = static_cast<std::uint8_t>(e);
      std::uint8_t& sheet = cell.sheet_of_edge[root(e)];
      if (sheet == 255) sheet = cell.sheets++;
      cell.sheet_of_edge[static_cast<std::size_t>(e)] = sheet;
    }
    return cell;
  }

 private:
  std::array<std::uint8_t, 12> parent_{};
};

// Of sets of corners, a bit each: those one edge away from these, and whether these hang together
// along edges.
constexpr unsigned neighbours(unsigned corners) {
  unsigned next = 0;
  for (unsigned i = 0; i < 8; ++i)
    if ((corners >> i & 1u) != 0) next |= 1u << (i ^ 1) | 1u << (i ^ 2) | 1u << (i ^ 4);
  return next;
}
constexpr bool one_component(unsigned corners) {
  unsigned reached = corners & (~corners + 1);
  for (unsigned before = 0; before != reached;) {
    before = reached;
    reached |= neighbours(reached) & corners;
  }
  return reached == corners;
}

}  // namespace voxweld
