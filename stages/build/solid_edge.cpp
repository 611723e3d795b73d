#include "stages/build/solid_edge.h"

#include <algorithm>

#include "stages/solids/lattice_solid.h"
#include "stages/solids/solid.h"

namespace voxweld {
namespace {

LatticeSolid::Crossing crossing_of(const Solid& solid, const VolumeFrame& frame, int axis, Index3 s,
                                   bool low_in_solid) {
  if (solid.shape == SolidShape::mesh) return solid.mesh->crossing(axis, s, low_in_solid);
  const Vec3 low = frame.place_of_sample(s);
  const double length = frame.spacing[axis];
  const double t = solid_crossing(solid, low, axis, length);
  Vec3 place = low;
  place[axis] += t * length;
  return {t, solid_normal(solid, place)};
}

}  // namespace

HermiteEdge edge_of_solid(const Solid& solid, const VolumeFrame& frame, int axis, Index3 s,
                          bool low_in_solid) {
  const auto crossing = crossing_of(solid, frame, axis, s, low_in_solid);
  HermiteEdge edge;
  edge.t = static_cast<float>(std::clamp(crossing.t, lowest_crossing, highest_crossing));
  for (int a = 0; a < 3; ++a)
    edge.normal[static_cast<std::size_t>(a)] = static_cast<float>(crossing.normal[a]);
  return edge;
}

}  // namespace voxweld
