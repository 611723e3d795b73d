#include "stages/refine/refine_cube.h"

#include <optional>

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
  if (parameters.mode != RefineMode::mend && parameters.settles)
    settle_places(edit, parameters, counts);
  if (parameters.intersections == IntersectionRule::none)
    repair_intersections(edit, parameters, counts, RepairEffort::thorough);
}

// Nearly no collapse makes triangles intersect that share no vertex, so none is asked whether it does:
// that takes up to a third of the time. What intersects in the end is mended, within the tolerance.
// Returns whether that leaves no pairs. Precondition: there are none before.
bool collapse_then_mend(EditMesh& edit, const RefineParameters& parameters, RefineCounts& counts) {
  const std::vector<std::uint32_t> old = edit.intersecting();  // of pairs that cannot change
  edit.begin_changes();
  collapse_edges(edit, parameters, CollapseCare::around, counts);
  edit.set_intersecting(edit.end_changes());
  repair_intersections(edit, parameters, counts, RepairEffort::thorough, parameters.tolerance);
  edit.add_intersecting(old);
  return edit.count_pairs() == 0;
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
  const RefineCounts before = counts;
  std::optional<EditMesh> edit;
  const auto start = [&] {
    counts = before;
    edit.emplace(mesh, box, parameters.samples);
    mend(*edit, mesh.checked, parameters, counts);
  };
  start();
  if (parameters.mode == RefineMode::collapse) {
    if (parameters.intersections == IntersectionRule::ignore) {
      collapse_edges(*edit, parameters, CollapseCare::none, counts);
    } else if (edit->count_pairs() > 0) {
      // Mostly noise, where others would come to intersect that cannot be mended either.
      collapse_edges(*edit, parameters, CollapseCare::all, counts);
    } else if (!collapse_then_mend(*edit, parameters, counts)) {
      start();
      collapse_edges(*edit, parameters, CollapseCare::all, counts);
    }
    settle_normals(*edit, parameters.reach, parameters.normals);
  }
  if (parameters.intersections != IntersectionRule::ignore) edit->complete_intersecting();
  counts.pairs_left += edit->count_pairs();
  mesh = std::move(*edit).take();
}

CollapseSurvey survey_cube(const RefineMesh& mesh, const LatticeBox& box,
                           const RefineParameters& parameters, std::span<const double> tolerances) {
  EditMesh edit(mesh, box, parameters.samples);
  RefineCounts counts;
  CollapseSurvey survey;
  survey.inside = count_movable(edit);
  survey.border = count_anchors(edit);
  mend(edit, mesh.checked, parameters, counts);
  // Nearly all collapses are those of refine_cube(), which counting does not need to the last one.
  edit.begin_changes();
  const bool ignores = parameters.intersections == IntersectionRule::ignore;
  collapse_by_steps(edit, parameters, tolerances,
                    ignores ? CollapseCare::none : CollapseCare::around, counts,
                    [&](std::size_t) { survey.left.push_back(count_movable(edit)); });
  return survey;
}

}  // namespace voxweld
