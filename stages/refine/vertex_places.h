// Vertices to where the volume wants them, and edges to where its normals do.
#pragma once

#include "stages/refine/edit_mesh.h"
#include "stages/refine/refine_range.h"

namespace voxweld {

// Moves vertices to their aims, or some of the way, and flips edges of triangles that stand against the
// normals of their vertices. An edge is flipped only where triangles agree better with these normals
// then, all in all, and a vertex moved only where they agree hardly less; and where nothing intersects.
// Without normals nothing is done.
void settle_places(EditMesh& mesh, const RefineParameters& parameters, RefineCounts& counts);

}  // namespace voxweld
