#include "stages/build/label_grid.h"

#include <algorithm>

namespace voxweld {

void LabelGrid::fill(const MaterialBlock& materials, Index3 brick, int side) {
  materials_ = materials.materials();
  points_ = static_cast<std::size_t>(side) + 1;
  labels_.assign(points_ * points_ * points_, materials.outside());
  const HaloBlock& block = materials.block();
  // Lattice point u is sample u - 1.
  const Index3 first = brick - splat(1);
  const Box3 held = intersect(block.samples, Box3{first, first + splat(side + 1)});
  if (held.empty()) return;
  const auto* data = reinterpret_cast<const std::uint32_t*>(block.data);
  for (std::int64_t z = held.lo.z; z < held.hi.z; ++z)
    for (std::int64_t y = held.lo.y; y < held.hi.y; ++y) {
      const Index3 from = Index3{held.lo.x, y, z} - block.samples.lo,
                   to = Index3{held.lo.x, y, z} - first;
      const std::uint32_t* p = data + from.z * block.slice + from.y * block.row + from.x;
      std::copy(p, p + held.size().x,
                labels_.begin() + ((to.z * (side + 1) + to.y) * (side + 1) + to.x));
    }
}

std::uint32_t LabelGrid::number_of(Material material) const {
  return static_cast<std::uint32_t>(
      std::lower_bound(materials_.begin(), materials_.end(), material) - materials_.begin());
}

CellLabels LabelGrid::cell(int x, int y, int z) const {
  const std::uint32_t* rows[4] = {row(y, z) + x, row(y + 1, z) + x, row(y, z + 1) + x,
                                  row(y + 1, z + 1) + x};
  CellLabels labels;
  for (std::size_t i = 0; i < 8; ++i) labels[i] = rows[i >> 1][i & 1];
  return labels;
}

NodeLabels LabelGrid::node(int x, int y, int z, int node_side) const {
  const int half = node_side / 2;
  NodeLabels labels;
  for (int i = 0; i < 27; ++i)
    labels[static_cast<std::size_t>(i)] =
        at(x + half * (i % 3), y + half * (i / 3 % 3), z + half * (i / 9));
  return labels;
}

NodeCrossings LabelGrid::crossings(int x, int y, int z) const {
  const NodeLabels labels = node(x, y, z, 2);
  NodeCrossings crossings{};
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (int point = 0; point < 27; ++point) {
      if ((edges_of_node[axis] >> point & 1) == 0) continue;
      const auto from = static_cast<std::size_t>(point);
      const bool differ = labels[from] != labels[from + static_cast<std::size_t>(bits_along[axis])];
      crossings[axis] |= std::uint32_t{differ} << point;
    }
  return crossings;
}

}  // namespace voxweld
