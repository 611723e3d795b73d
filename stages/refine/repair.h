// Mends triangles that intersect.
#pragma once

#include <cstdint>
#include <limits>
#include <span>

#include "stages/refine/edit_mesh.h"
#include "stages/refine/refine_range.h"

namespace voxweld {

enum class RepairEffort : std::uint8_t {
  quick,     // leaves out moves that are unlikely to help
  thorough,  // where nothing else helps tries moves in all directions: ten times as many
};

// Moves vertices, flips and collapses edges around triangles that intersect, each time only where
// fewer pairs are left. Smallest moves first: along the surface, then towards the middle of the
// neighbours. None further than parameters.reach, and no sample further than `most`.
void repair_intersections(EditMesh& mesh, const RefineParameters& parameters, RefineCounts& counts,
                          RepairEffort effort,
                          double most = std::numeric_limits<double>::infinity());

// The same of a mesh that was repaired with as much effort before and has changed since, around some
// vertices: nothing is tried again where none of them is.
void repair_around(EditMesh& mesh, std::span<const std::uint32_t> changed,
                   const RefineParameters& parameters, RefineCounts& counts, RepairEffort effort);

}  // namespace voxweld
