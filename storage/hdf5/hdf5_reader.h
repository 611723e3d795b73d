// Volumes in HDF5 files: support.hdfgroup.org/documentation/hdf5. Datasets of three dimensions of
// integers or floats, with filters or without; Imaris and MINC 2 files; the axes and spacings that
// ilastik, Fiji, NeXus and CREMI write. In a module, as few runs read such files.
#pragma once

#include "storage/types/volume_reader.h"

namespace voxweld {

// The row of the table. Detection loads nothing.
VolumeReader hdf5_reader();

}  // namespace voxweld
