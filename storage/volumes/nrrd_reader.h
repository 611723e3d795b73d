// NRRD, attached (.nrrd) and detached (.nhdr): teem.sourceforge.net/nrrd/format.html.
#pragma once

#include "storage/types/volume_reader.h"

namespace voxweld {

// 3-D scalar volumes, also with further axes of size 1. Encodings raw (Access::box), gzip and text
// (Access::stream). FormatError for others, for vectors and colours, and for damaged files.
VolumeReader nrrd_reader();

}  // namespace voxweld
