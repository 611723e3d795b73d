#include "stages/refine/refine_cube.h"

#include "stages/refine/collapse.h"
#include "stages/refine/repair.h"
#include "stages/refine/vertex_normals.h"
#include "stages/refine/vertex_places.h"

namespace voxweld {

void refine_cube(RefineMesh& mesh, const LatticeBox& box, const RefineParameters& parameters,
                 RefineCounts& counts) {
  EditMesh edit(mesh, box);
  if (parameters.intersections != IntersectionRule::ignore) {
    if (!mesh.checked) edit.set_intersecting(edit.find_intersecting());
    counts.pairs_before += edit.count_pairs();
  }
  settle_places(edit, parameters, counts);
  if (parameters.intersections == IntersectionRule::none)
    repair_intersections(edit, parameters, counts);
  if (parameters.mode == RefineMode::collapse) {
    collapse_edges(edit, parameters, counts);
    settle_normals(edit, parameters.reach);
  }
  counts.pairs_left += edit.count_pairs();
  mesh = std::move(edit).take();
}

}  // namespace voxweld
