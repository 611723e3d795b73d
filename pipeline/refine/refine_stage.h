// Refine and seams: the mesh repaired and simplified, cube by cube, in two passes. (find_stage.h and
// mend_stage.h where it is only repaired.)
#pragma once

#include <memory>

#include "pipeline/refine/collapse_choice.h"
#include "pipeline/refine/cube_meshes.h"
#include "pipeline/stage/artifacts.h"
#include "pipeline/stage/stage_work.h"

namespace voxweld {

// What the work refers to, and outlives it.
struct RefineInputs {
  const RefineJob& job;
  const std::vector<RefineUnit>& units;
  std::vector<MeshLayer>
      meshes;  // what it reads; of those that refine makes the units are the same
  std::uint64_t tile_vertices = 0;       // for messages
  CollapseChoice* choice = nullptr;      // of the job's tolerance, where it has a target
  std::optional<MeshLayer> places = {};  // of mend: who says what intersects, if not the meshes
};

std::unique_ptr<StageWork> refine_stage(const RefineInputs& inputs);

// Where the stage leaves its meshes, in the order of its units.
std::vector<std::filesystem::path> refined_meshes(const RefineJob& job,
                                                  const std::vector<RefineUnit>& units);
// The sum over all of them.
RefineCounts refine_counts(const RefineJob& job, const std::vector<RefineUnit>& units);

}  // namespace voxweld
