// Quads to triangles.
#pragma once

#include <array>

#include "stages/stitch/snap.h"
#include "storage/types/brick_octree.h"
#include "storage/types/morton.h"

namespace voxweld {

struct QuadCorner {
  LatticePoint point{};
  VertexId id;
  std::array<PackedNormal, max_clusters> normals{};  // clusters of its Hermite normals
  NormalSense sense = NormalSense::outward;
};

// True to cut from corner 1 to corner 3, false from 0 to 2. A function of the snapped positions,
// the normals and the ids alone. In order:
//   1. the cut with no triangle of no area, then with none that faces away from its corners'
//      normals; where each has one, the cut with no triangle turned over seen along the lattice
//      edge that the quad's leaves share: they lie in the four quadrants around it, so one cut has
//      none;
//   2. the cut whose diagonal leaves the surface least: the height at which it passes each of its
//      ends' tangent planes, the nearest of each end's, both together. Along a crease both ends
//      have both planes and the height is none, while across it each end has its own: so a crease
//      is not bevelled. Heights within one lattice step, the accuracy of positions, are equal;
//   3. the flatter cut, the shorter diagonal, the diagonal with the lowest id.
// Normals of either sense are first turned to the quad's own side.
bool cut_from_one(const std::array<QuadCorner, 4>& quad);

// Twice the triangle's area vector, in lattice steps; exact.
Vec3 area_vector(const LatticePoint& a, const LatticePoint& b, const LatticePoint& c);

}  // namespace voxweld
