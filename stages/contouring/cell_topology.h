// The combinatorics of one cell: numbering, sheets, problem cells, and the collapse test.
//
// Based on: Nielson, "Dual Marching Cubes", 2004 (a vertex for each loop of face arcs); Wenger,
// "Isosurfaces", 2013 (problem cells); Ju, Losasso, Schaefer, Warren, "Dual Contouring of Hermite
// Data", 2002, section 4 (safe collapse). Where it differs: the connectivity test is asked of the
// inside and of the outside corners, see `collapsible`.
//
// Corner i lies at (i & 1, i >> 1 & 1, i >> 2). Edge e runs along axis e / 4; the two low bits of e
// are its place on the other two axes, the lower axis in bit 0:
//
//        6-------7            z       edges 0 .. 3 along x at (y, z) = (0,0) (1,0) (0,1) (1,1)
//       /|      /|            |       edges 4 .. 7 along y at (x, z)
//      4-------5 |            | y     edges 8 .. 11 along z at (x, y)
//      | 2-----|-3            |/
//      |/      |/             o--x    face 2 a + s: the face with coordinate s on axis a
//      0-------1
#pragma once

#include <array>
#include <bit>
#include <cstdint>

namespace voxweld {

// Sign byte: bit i set when corner i is inside.
using CellSigns = std::uint8_t;

struct EdgeCorners {
  std::uint8_t low, high;
};
constexpr EdgeCorners edge_corners(int edge) {
  const int axis = edge >> 2, first = edge & 1, second = edge >> 1 & 1;
  const int low = axis == 0   ? first << 1 | second << 2
                  : axis == 1 ? first | second << 2
                              : first | second << 1;
  return {static_cast<std::uint8_t>(low), static_cast<std::uint8_t>(low | 1 << axis)};
}
// The edge along `axis` whose low corner is `corner`.
constexpr int edge_at(int axis, int corner) {
  const int x = corner & 1, y = corner >> 1 & 1, z = corner >> 2;
  return axis == 0 ? (y | z << 1) : axis == 1 ? 4 + (x | z << 1) : 8 + (x | y << 1);
}
// The edge from corner p to its neighbour q.
constexpr int edge_between(int p, int q) {
  return edge_at(std::countr_zero(static_cast<unsigned>(p ^ q)), p < q ? p : q);
}

// Corners of a face in cyclic order, starting at its lowest.
constexpr std::array<int, 4> face_corners(int face) {
  const int axis = face >> 1, base = (face & 1) << axis;
  const int b = 1 << (axis + 1) % 3, c = 1 << (axis + 2) % 3;
  return {base, base | b, base | b | c, base | c};
}

struct CellSheets {
  std::uint8_t sheets = 0;                       // loops of face arcs, 0 .. 4
  std::uint8_t crossings = 0;                    // edges with a sign change
  std::array<std::uint8_t, 12> edges{};          // those edges, ascending
  std::array<std::uint8_t, 12> sheet_of_edge{};  // 255: no crossing
};

namespace topology_detail {
struct Tables {
  std::array<std::array<CellSheets, 256>, 2> sheets;  // [joined][signs]
  std::array<std::uint8_t, 256> most_sheets;
  std::array<std::int8_t, 256> problem_face;
  std::array<bool, 256> collapsible;
};
extern const Tables tables;
}  // namespace topology_detail

// The sheets of a cell, numbered by their lowest crossing edge. joined: the cell's problem face is
// paired so that its inside corners are joined (Wenger's rule applies, see joins_across).
inline const CellSheets& cell_sheets(CellSigns signs, bool joined) {
  return topology_detail::tables.sheets[joined][signs];
}

// Of a cell that may be joined or not.
inline int most_sheets(CellSigns signs) {
  return topology_detail::tables.most_sheets[signs];
}

// The face of a problem cell (one sheet holds all four crossings of that ambiguous face), or -1.
inline int problem_face(CellSigns signs) {
  return topology_detail::tables.problem_face[signs];
}

// True when a cell and the one across its face are problem cells for that same face: then both
// pair it the joined way, and the mesh stays 2-manifold; nothing else flips.
inline bool joins_across(CellSigns signs, int face, CellSigns across) {
  return problem_face(signs) == face && problem_face(across) == (face ^ 1);
}

// The inside corners form one component along cube edges and the outside corners another: 126 of
// 256. None of these has an ambiguous face; each has one sheet.
inline bool collapsible(CellSigns signs) {
  return topology_detail::tables.collapsible[signs];
}

// The collapse test of section 4 on the 27 lattice signs of a node at half its side (bit x + 3 y +
// 9 z): the corners pass `collapsible`, each edge's middle agrees with an end, each face's with a
// corner, the centre with a corner.
bool signs_allow_collapse(std::uint32_t signs27);

// The 27 signs from the corner signs of the eight children in octant order.
std::uint32_t gather_signs27(const std::array<CellSigns, 8>& children);
CellSigns corners_of_signs27(std::uint32_t signs27);

}  // namespace voxweld
