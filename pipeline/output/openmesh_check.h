// A second opinion on a whole mesh, from OpenMesh's half-edge structure.
#pragma once

#include <string>
#include <vector>

#include "stages/encode/lattice_mesh.h"

namespace voxweld {

// What OpenMesh finds wrong: faces it cannot add, vertices that are not manifold and, unless
// `open_border`, boundary edges. On an open border vertices with several fans are split first.
// Empty: nothing. Takes about 150 bytes a triangle.
std::vector<std::string> openmesh_problems(LatticeMesh mesh, bool open_border);

}  // namespace voxweld
