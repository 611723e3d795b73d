// The part of a mesh that lies in a box.
#pragma once

#include "storage/types/box.h"
#include "storage/types/tile_mesh.h"

namespace voxweld {

// The triangles whose own bounding box meets the box lo .. hi, borders included, in their order, and
// the vertices they use, by first use. lo, hi: in the frame of mesh.lattice. What is said of polygons
// is that of the whole mesh no more: it is 0.
TileMesh cropped(const TileMesh& mesh, Vec3 lo, Vec3 hi);

}  // namespace voxweld
