// NIfTI-1 and NIfTI-2: one file (.nii, .nii.gz) or a pair (.hdr, .img): nifti.nimh.nih.gov.
#pragma once

#include "storage/types/volume_reader.h"

namespace voxweld {

// One 3-D scalar volume. Uncompressed is Access::box, gzip Access::stream. `path` may be either
// file of a pair. The stored values are read as they are: a slope and intercept in the header is a
// warning. FormatError for several volumes, colours, complex numbers and damaged files.
VolumeReader nifti_reader();

}  // namespace voxweld
