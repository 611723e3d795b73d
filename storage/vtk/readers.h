// The readers of VTK's files of images: rows of the table in storage/readers.
#pragma once

#include "storage/types/volume_reader.h"

namespace voxweld {

// VTK XML ImageData, .vti: docs.vtk.org, "VTK XML formats". One piece; data as text, base64 or raw,
// inline or appended, uncompressed or in blocks of zlib, LZ4 or LZMA.
VolumeReader vti_reader();

// The older format of VTK, .vtk: "# vtk DataFile Version", text or binary (big-endian), of data set
// STRUCTURED_POINTS.
VolumeReader vtk_reader();

}  // namespace voxweld
