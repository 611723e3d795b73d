// The work of refine in one cube.
#pragma once

#include "stages/refine/refine_range.h"

namespace voxweld {

// Changes what lies in `box`: triangles with all corners there. All others stay as they are, and so
// do vertices that one of those uses; their triangles serve for testing only.
// mesh: holds each triangle that meets the box. On return its unused vertices are left in it; the
// order of its triangles is of no meaning.
void refine_cube(RefineMesh& mesh, const LatticeBox& box, const RefineParameters& parameters,
                 RefineCounts& counts);

// What would be left of the triangles in `box` with each of these tolerances, which ascend.
CollapseSurvey survey_cube(const RefineMesh& mesh, const LatticeBox& box,
                           const RefineParameters& parameters, std::span<const double> tolerances);

}  // namespace voxweld
