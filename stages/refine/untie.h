// Mends pairs of triangles that no single change mends.
#pragma once

#include <array>
#include <set>
#include <vector>

#include "stages/refine/edit_mesh.h"
#include "stages/refine/refine_range.h"

namespace voxweld {

// Triangles that intersect each other, by the ids of their vertices; ascending.
using Knot = std::vector<std::array<VertexId, 3>>;

// Makes a change around a pair on trial, whatever it comes upon, and repairs on from there; keeps what
// comes of it where fewer pairs are left in the end. Small changes first. Each trial works on a copy of
// the mesh, so it should be small; and of many pairs some are left as they are.
//
// tied: knots that nothing helps with are left out, since that takes seconds to find; new ones are
// added.
//
// Precondition: the mesh was repaired.
void untie_intersections(EditMesh& mesh, const RefineParameters& parameters, std::set<Knot>& tied,
                         RefineCounts& counts);

}  // namespace voxweld
