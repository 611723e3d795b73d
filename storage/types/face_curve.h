// Where the surface meets the border of an octree node: as much as its parent needs, to tell what it
// has of sheets without a look at finest cells (stages/contouring/node_shape.h).
#pragma once

#include <compare>
#include <cstdint>

#include "storage/types/box.h"

namespace voxweld {

// For the number of a cluster: there is none.
inline constexpr std::uint32_t no_cluster = 0xffffffffu;

// A finest lattice edge with a sign change: its axis and its low end, a lattice point.
struct Crossing {
  std::uint64_t bits = 0;

  static constexpr Crossing make(int axis, Index3 low) {
    return {static_cast<std::uint64_t>(axis) << 60 | static_cast<std::uint64_t>(low.x) << 40 |
            static_cast<std::uint64_t>(low.y) << 20 | static_cast<std::uint64_t>(low.z)};
  }
  constexpr int axis() const { return static_cast<int>(bits >> 60); }
  constexpr std::int64_t operator[](int a) const {
    return static_cast<std::int64_t>(bits >> (40 - 20 * a) & 0xfffff);
  }
  friend constexpr auto operator<=>(Crossing, Crossing) = default;
};

// Where a cluster meets a face of its node: a chain of arcs. It ends at crossings on the face's
// border, or is closed. A face has the same curves for the nodes on both its sides.
struct FaceCurve {
  // Its ends, the lower first. Closed: one of the crossings it passes, twice, the same one seen
  // from both sides.
  Crossing low, high;
  std::uint32_t cluster = 0;  // of the node
  std::uint16_t face = 0;     // 2 a + s, as in cell_topology.h
  std::uint16_t closed = 0;   // 1: it is
};

// An ambiguous finest face on the node's border, with an arc of each of these curves of its face.
struct CurvePair {
  std::uint32_t first = 0, second = 0;
  friend constexpr auto operator<=>(const CurvePair&, const CurvePair&) = default;
};

}  // namespace voxweld
