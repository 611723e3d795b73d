// Levels: coarser versions of the mesh, node by node of a tree above its tiles (level_tree.h).
#pragma once

#include <memory>

#include "pipeline/refine/node_reads.h"
#include "pipeline/stage/stage_work.h"

namespace voxweld {

// Units are nodes, children in rounds before their parents. Sources outlive the work.
std::unique_ptr<StageWork> levels_stage(const NodeSources& sources);

}  // namespace voxweld
