// Ingest of a mesh that does not fit memory: cut up by the bricks it reaches.
#pragma once

#include "pipeline/solids/streamed_mesh.h"
#include "pipeline/stage/stage_work.h"

namespace voxweld {

// One unit: the mesh. Both outlive the work.
std::unique_ptr<StageWork> mesh_ingest(const Config& config, StreamedMesh& mesh);

}  // namespace voxweld
