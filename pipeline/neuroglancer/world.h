// Where the points of the files lie in Neuroglancer's world, which is measured in nanometres.
#pragma once

#include <array>

#include "storage/types/output_lattice.h"
#include "storage/types/volume.h"

namespace voxweld {

// Rows of three by four numbers: direction and origin of the frame, in nanometres. One of a unit that is
// not known, or that the input does not name, counts as a nanometre.
std::array<double, 12> nanometre_matrix(const VolumeGeometry& frame);

// The world looks at the mesh from the other side of a mirror: triangles run the other way around.
bool is_mirrored(const VolumeGeometry& frame);

}  // namespace voxweld
