// Checks a mesh that does not fit memory: that it is closed, and which way it faces.
#pragma once

#include "pipeline/run/spooled_mesh.h"

namespace voxweld {

// InputError for one that is not closed, with its holes as read_closed_mesh tells them
// (closed_mesh.h), or their first edges where they are too many for the memory. Warns of one that
// faces inward.
void check_spooled_mesh(const std::filesystem::path& path, const SpooledMesh& mesh,
                        const MeshWork& work);

}  // namespace voxweld
