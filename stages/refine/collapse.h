// Edge collapse by quadrics in one cube.
#pragma once

#include <functional>
#include <span>

#include "stages/refine/edit_mesh.h"
#include "stages/refine/refine_range.h"

namespace voxweld {

// Which triangles a collapse may not intersect.
enum class CollapseCare : std::uint8_t {
  all,     // any
  around,  // those that share a vertex with what is new
  none,
};

// Collapses edges, those that cost least first, as long as
// - the mesh stays a manifold of the same topology (link condition),
// - no triangle turns far or loses its area,
// - the mean distance to the planes that a vertex stands for, and the distance of each sample to the
//   triangles that stand for it, stay within the tolerance,
// - nothing intersects that did not, as far as care is taken.
// Garland and Heckbert, 1997, with the area-weighted planes of the triangles as they come.
void collapse_edges(EditMesh& mesh, const RefineParameters& parameters, CollapseCare care,
                    RefineCounts& counts);

// The same with one tolerance after the other in place of the parameters' own: planes go on adding
// up. Calls after(i) when it is done with the i-th. Precondition: they ascend.
void collapse_by_steps(EditMesh& mesh, const RefineParameters& parameters,
                       std::span<const double> tolerances, CollapseCare care, RefineCounts& counts,
                       const std::function<void(std::size_t)>& after);

}  // namespace voxweld
