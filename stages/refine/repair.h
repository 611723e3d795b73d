// Mends triangles that intersect.
#pragma once

#include "stages/refine/edit_mesh.h"
#include "stages/refine/refine_range.h"

namespace voxweld {

// Moves vertices, flips and collapses edges around triangles that intersect, each time only where
// fewer pairs are left. Smallest moves first: along the surface, then towards the middle of the
// neighbours. None further than parameters.reach.
void repair_intersections(EditMesh& mesh, const RefineParameters& parameters, RefineCounts& counts);

}  // namespace voxweld
