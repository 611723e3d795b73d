// Grids in OpenVDB's files: openvdb.org. The box of active voxels with one sample more on each side,
// which closes surfaces. In a module, as few runs read such files.
#pragma once

#include "storage/types/volume_reader.h"

namespace voxweld {

// The row of the table. Detection loads nothing.
VolumeReader vdb_reader();

}  // namespace voxweld
