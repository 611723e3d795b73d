// Which triangles of a mesh intersect.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "stages/exact/box_tree.h"
#include "stages/exact/triangle_pair.h"

namespace voxweld {

struct TriangleList {
  std::span<const LatticePoint> positions;
  std::span<const std::array<std::uint32_t, 3>> triangles;

  LatticeTriangle operator[](std::size_t i) const {
    return {positions[triangles[i][0]], positions[triangles[i][1]], positions[triangles[i][2]]};
  }
  std::size_t size() const { return triangles.size(); }
};

// The boxes of the triangles, in their order.
std::vector<LatticeBox> boxes_of(const TriangleList& mesh);

using PairVisitor = std::function<void(std::uint32_t, std::uint32_t)>;

// f(i, j), i < j, for each pair that intersects (intersect_beyond_shared), ascending by i.
void each_intersection(const TriangleList& mesh, const PairVisitor& f);

// f(i, j) for each triangle i of the one and j of the others that do.
struct OtherTriangles {
  std::span<const LatticeTriangle> triangles;
  const BoxTree& tree;  // of their boxes
};
void each_intersection(const TriangleList& mesh, const OtherTriangles& others,
                       const PairVisitor& f);

}  // namespace voxweld
