// Mends pairs of triangles that no single change mends.
#pragma once

#include "stages/refine/edit_mesh.h"
#include "stages/refine/refine_range.h"

namespace voxweld {

// Makes a change around a pair on trial, whatever it comes upon, and repairs on from there; keeps what
// comes of it where fewer pairs are left in the end. Small changes first. Each trial works on a copy of
// the mesh, so it should be small; and of many pairs some are left as they are.
//
// Precondition: the mesh was repaired.
void untie_intersections(EditMesh& mesh, const RefineParameters& parameters, RefineCounts& counts);

}  // namespace voxweld
