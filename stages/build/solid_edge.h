// The Hermite datum of a lattice edge that a solid's surface crosses: exact.
#pragma once

#include "stages/build/hermite_edge.h"
#include "stages/solids/volume_frame.h"
#include "storage/types/solid.h"

namespace voxweld {

// Of the edge along `axis` from sample s to the next; the normal points out of the solid.
// Precondition: one of its ends lies in the solid.
HermiteEdge edge_of_solid(const Solid& solid, const VolumeFrame& frame, int axis, Index3 s,
                          bool low_in_solid);

}  // namespace voxweld
