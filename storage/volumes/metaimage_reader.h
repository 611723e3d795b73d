// MetaImage, .mha (header and samples) and .mhd (header beside the samples), as ITK reads them.
#pragma once

#include "storage/types/volume_reader.h"

namespace voxweld {

// 3-D scalar volumes, also with further axes of size 1. Raw samples are Access::box, compressed and
// text ones Access::stream. FormatError for several channels and for damaged files.
VolumeReader metaimage_reader();

}  // namespace voxweld
