// The Hermite datum of one lattice edge.
#pragma once

#include <array>

#include "stages/build/kink_gate.h"

namespace voxweld {

struct HermiteEdge {
  float t = 0;                    // of the crossing, 0 at the edge's low end, in [1/256, 255/256]
  std::array<float, 3> normal{};  // unit, outward, physical
};

// Of an edge with one end in the ring, or of which no more is known than its ends.
inline HermiteEdge edge_of_middle(int axis, bool low_inside) {
  HermiteEdge edge;
  edge.t = 0.5f;
  edge.normal[static_cast<std::size_t>(axis)] = low_inside ? 1.0f : -1.0f;
  return edge;
}

// The same crossing with its normal turned around.
inline HermiteEdge reversed(HermiteEdge edge) {
  for (float& n : edge.normal) n = n == 0 ? 0 : -n;  // no negative zeros
  return edge;
}

}  // namespace voxweld
