// Quads to triangles.
#pragma once

#include <array>

#include "stages/stitch/snap.h"
#include "storage/types/morton.h"

namespace voxweld {

struct QuadCorner {
  LatticePoint point{};
  VertexId id;
};

// True to cut from corner 1 to corner 3, false from 0 to 2. A function of the snapped positions and
// the ids alone: the flatter of the two cuts (never one with a triangle of no area if the other has
// none), then the shorter diagonal, then the one with the lowest id.
bool cut_from_one(const std::array<QuadCorner, 4>& quad);

// Twice the triangle's area vector, in lattice steps; exact.
Vec3 area_vector(const LatticePoint& a, const LatticePoint& b, const LatticePoint& c);

}  // namespace voxweld
