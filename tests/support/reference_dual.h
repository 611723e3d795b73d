// The topology of uniform dual contouring, written from the definitions with maps and no tables, to
// judge the real code by.
//
// Based on: Nielson, "Dual Marching Cubes" (2004): a cell has one vertex for each loop of its face
// arcs; Wenger, "Isosurfaces" (2013): how the ambiguous faces between two problem cells are paired
// so that the result is 2-manifold.
#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <map>
#include <set>
#include <vector>

#include "tests/support/mesh_check.h"
#include "tests/support/sign_grid.h"

namespace voxweld::testing {

// Numbering within a cell. Corner c: bit 0 is x, bit 1 y, bit 2 z. Edge e = 4 * axis + i along
// `axis`; the low bit of i is the position on the lower of the two other axes, the high bit on the
// higher:
//
//        6-----7          edge 0: corners 0-1   4: 0-2   8: 0-4
//       /|    /|               1: 2-3           5: 1-3   9: 1-5
//      4-----5 |               2: 4-5           6: 4-6  10: 2-6
//      | 2---|-3   z y         3: 6-7           7: 5-7  11: 3-7
//      |/    |/    |/
//      0-----1     o-x    face f = 2 * axis + side (0 low, 1 high)
struct CellEdge {
  int axis = 0, low = 0, high = 0;  // corners
};
CellEdge cell_edge(int edge);

// A cell's corner by position, ordered z, y, x: the order of raster scans.
struct CellIndex {
  std::int64_t z = 0, y = 0, x = 0;
  friend auto operator<=>(const CellIndex&, const CellIndex&) = default;
};

using Patch = std::set<int>;  // the crossing edges of one loop

// The patches of a cell with these corner signs (bit c: corner c is inside), numbered by lowest
// edge. In an ambiguous face the arcs cut off the inside corners, except in the faces of `joined`,
// where they cut off the outside ones.
std::vector<Patch> patches_of(unsigned corner_signs, const std::set<int>& joined = {});
// Faces whose four edges all cross.
std::set<int> ambiguous_faces(unsigned corner_signs);
// The ambiguous faces whose four crossings lie in one patch (nothing joined). At most one.
std::set<int> problem_faces(unsigned corner_signs);

struct DualCorner {
  CellIndex cell;
  int patch = 0;
  friend auto operator<=>(const DualCorner&, const DualCorner&) = default;
};
// Counter-clockwise seen from outside.
using DualQuad = std::array<DualCorner, 4>;

struct ReferenceDual {
  std::map<CellIndex, std::vector<Patch>> cells;  // those with a crossing
  std::vector<DualQuad> quads;                    // by low end of the edge (z, y, x), then axis

  // Vertices numbered in the order of cells and patches; each quad split along corners 0 - 2.
  std::vector<Triangle> triangles() const;
  std::size_t vertices() const;
};

enum class AmbiguousFaces {
  wenger,    // joined where both cells are problem cells for the face
  separate,  // never joined: not always 2-manifold
};
ReferenceDual reference_dual(const SignGrid& grid, AmbiguousFaces rule = AmbiguousFaces::wenger);

}  // namespace voxweld::testing
