// The planes of one node of 2^3 cells, one edge after the other: what NodePlanes is compared with.
#pragma once

#include <bit>

#include "stages/build/cell_planes.h"
#include "stages/build/collapse_rule.h"

namespace voxweld::testing {

// All planes of the node whose lowest cell is at c, by axis and then in the order edges are kept, relative
// to its centre. An edge weighs as many cells of the node as it is of.
inline void gather_node_planes(LocalCell c, const NodeCrossings& crossings,
                               const HermiteEdges& edges, Vec3 spacing, SheetPlanes& out) {
  out.count = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const auto at = static_cast<std::size_t>(axis);
    for (std::uint32_t rest = crossings[at]; rest != 0;) {
      const int row = std::countr_zero(rest) / 3, y = row % 3, z = row / 3;
      std::uint32_t here = rest >> (3 * row) & 7;
      rest &= ~(std::uint32_t{7} << (3 * row));
      const HermiteEdge* edge = &edges.at(axis, c.x + std::countr_zero(here), c.y + y, c.z + z);
      for (; here != 0; here &= here - 1, ++edge) {
        const std::array<int, 3> low = {std::countr_zero(here), y, z};
        const std::size_t k = out.count++;
        HermitePlane& plane = out.all_planes[k];
        plane.weight = 1;
        for (std::size_t a = 0; a < 3; ++a) {
          plane.normal[a] = static_cast<double>(edge->normal[a]);
          const double along = a == at ? static_cast<double>(edge->t) : 0.0;
          plane.point[a] = (low[a] - 1 + along) * spacing[static_cast<int>(a)];
          if (a != at && low[a] == 1) plane.weight *= 2;
        }
        const auto weight = static_cast<float>(plane.weight);
        for (std::size_t a = 0; a < 3; ++a) out.all_normals[k][a] = weight * edge->normal[a];
      }
    }
  }
}

}  // namespace voxweld::testing
