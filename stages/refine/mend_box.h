// Mends a box of a refined mesh.
#pragma once

#include "stages/refine/refine_range.h"

namespace voxweld {

// Repairs what intersects in a box, and changes nothing but triangles with all corners there. Returns
// these, as they are then, with the vertices that they use. counts: of pairs with such a triangle,
// before and after; and how many more samples have a distance than before, modulo 2^64.
//
// Preconditions: mesh holds all triangles that meet the box. parameters.mode is repair, or mend: that
// also goes about what no single change helps (untie.h).
RefineMesh mend_box(const RefineMesh& mesh, const LatticeBox& box,
                    const RefineParameters& parameters, RefineCounts& counts);

}  // namespace voxweld
