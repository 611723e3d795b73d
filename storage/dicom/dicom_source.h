// A DICOM series or file as a volume.
//
// Axes: x along a row, y down the columns, z along the normal of the slices, which is x times y.
// The world is the patient's, "LPS", in mm.
#pragma once

#include <memory>

#include "storage/types/volume_reader.h"

namespace voxweld {

// spec.path: a folder, one file, or a DICOMDIR. The headers of all files are read, no samples but
// those of slices at one place. Access::slice; `read` from one thread at a time.
// InputError for a choice that is open or wrong, FormatError for what is damaged or no volume.
std::unique_ptr<SampleSource> open_dicom(const InputSpec& spec);

}  // namespace voxweld
