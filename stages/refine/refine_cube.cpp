#include "stages/refine/refine_cube.h"

#include "stages/refine/collapse.h"
#include "stages/refine/repair.h"
#include "stages/refine/vertex_normals.h"
#include "stages/refine/vertex_places.h"

namespace voxweld {
namespace {

// All that comes before collapse.
void mend(EditMesh& edit, bool checked, const RefineParameters& parameters, RefineCounts& counts) {
  if (parameters.intersections != IntersectionRule::ignore) {
    if (!checked) edit.set_intersecting(edit.find_intersecting());
    counts.pairs_before += edit.count_pairs();
  }
  if (parameters.mode != RefineMode::mend) settle_places(edit, parameters, counts);
  if (parameters.intersections == IntersectionRule::none)
    repair_intersections(edit, parameters, counts, RepairEffort::thorough);
}

std::uint64_t count_movable(const EditMesh& edit) {
  std::uint64_t count = 0;
  for (std::uint32_t t = 0; t < edit.triangles(); ++t)
    count += edit.alive(t) && edit.movable(t) ? 1 : 0;
  return count;
}

std::uint64_t count_anchors(const EditMesh& edit) {
  std::uint64_t count = 0;
  for (std::uint32_t v = 0; v < edit.vertices(); ++v)
    count += !edit.gone(v) && edit.freedom(v) == Freedom::anchor ? 1 : 0;
  return count;
}

}  // namespace

void refine_cube(RefineMesh& mesh, const LatticeBox& box, const RefineParameters& parameters,
                 RefineCounts& counts) {
  EditMesh edit(mesh, box);
  mend(edit, mesh.checked, parameters, counts);
  if (parameters.mode == RefineMode::collapse) {
    collapse_edges(edit, parameters, counts);
    settle_normals(edit, parameters.reach, parameters.normals);
  }
  counts.pairs_left += edit.count_pairs();
  mesh = std::move(edit).take();
}

CollapseSurvey survey_cube(const RefineMesh& mesh, const LatticeBox& box,
                           const RefineParameters& parameters, std::span<const double> tolerances) {
  EditMesh edit(mesh, box);
  RefineCounts counts;
  CollapseSurvey survey;
  survey.inside = count_movable(edit);
  survey.border = count_anchors(edit);
  mend(edit, mesh.checked, parameters, counts);
  collapse_by_steps(edit, parameters, tolerances, counts,
                    [&](std::size_t) { survey.left.push_back(count_movable(edit)); });
  return survey;
}

}  // namespace voxweld
