// Which samples of a mesh are looked after while coarser levels are made of it.
#pragma once

#include "stages/refine/refine_range.h"
#include "storage/types/refine_mesh.h"

namespace voxweld {

// Leaves of each triangle's samples the farthest one, if it is farther than an eighth of this tolerance. For
// what is nearer the triangle's corners stand, to which a coarser mesh stays near too. tolerance: of the
// coarser mesh, in lattice steps.
void thin_samples(RefineMesh& mesh, double tolerance);

// Leaves of each triangle's samples the farthest one, and counts the distances of all. Threads that are free
// help.
void keep_farthest_samples(RefineMesh& mesh, RefineCounts& counts);

}  // namespace voxweld
