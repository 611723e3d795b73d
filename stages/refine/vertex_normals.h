// The normals of vertices after their triangles have grown.
#pragma once

#include "stages/refine/edit_mesh.h"
#include "stages/refine/refine_range.h"

namespace voxweld {

// Near a crease the volume tells normals to a few degrees, which nobody sees on triangles as small as
// a cell. On a large flat triangle it would be a shadow; but its own normal is all the better. So to
// each direction of a free vertex come the triangles near it, weighed by their area: as much as the
// volume's normal weighs where they cover 16 cells. Those that are near none are a direction of their
// own where there is room, or where they are larger than what there is. Near means within 40 degrees: on
// smooth surfaces triangles stand up to 25 off, and with a normal of its own each would show as a facet.
// cell: a side of one, in lattice steps.
void settle_normals(EditMesh& mesh, double cell, const NormalRule& rule);

}  // namespace voxweld
