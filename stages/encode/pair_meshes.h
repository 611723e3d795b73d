// One mesh for each pair of labels of a mesh between labels.
#pragma once

#include <cstdint>
#include <vector>

#include "storage/types/tile_mesh.h"

namespace voxweld {

// The triangles of mesh.pairs[i], for each i; vertices in the order of first use, triangles in
// theirs; quads and polygon_triangles are not told apart and left 0. Each is empty of pairs itself.
std::vector<TileMesh> split_by_pair(const TileMesh& mesh);

}  // namespace voxweld
