// NIfTI-1 and NIfTI-2: one file (.nii, .nii.gz) or a pair (.hdr, .img): nifti.nimh.nih.gov.
#pragma once

#include <filesystem>
#include <memory>

#include "storage/readers/open_volume.h"
#include "storage/types/volume.h"

namespace voxweld {

Match sniff_nifti(const InputProbe& probe);

// One 3-D scalar volume. Uncompressed is Access::box, gzip Access::stream. `path` may be either
// file of a pair. The stored values are read as they are: a slope and intercept in the header is a
// warning. FormatError for several volumes, colours, complex numbers and damaged files.
std::unique_ptr<SampleSource> open_nifti(const std::filesystem::path& path);

}  // namespace voxweld
