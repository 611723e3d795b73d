// What the triangles around a vertex look like.
#pragma once

#include <cstdint>
#include <span>

#include "storage/types/material.h"

namespace voxweld {

// In the order in which vertices give way: of two that become one, the lower kind goes.
// (Dey, Edelsbrunner, Guha, Nekhayev, "Topology Preserving Edge Contraction", 1999, call them the
// vertices of order 0, 1 and 2.)
enum class StarKind : std::uint8_t {
  disc,   // one ring, which separates one pair of labels
  line,   // three or more sheets that meet in one line through it, like the pages of a book
  rim,    // one fan of one sheet, which an open border ends
  point,  // all else: where lines meet or end, where sheets touch
};

// Of a triangle at the vertex the opposite edge, in the triangle's direction.
struct LinkEdge {
  std::uint32_t from = 0, to = 0;
  MaterialPair sides;
};

// Precondition: these are all its triangles.
StarKind kind_of_star(std::span<const LinkEdge> link);

}  // namespace voxweld
