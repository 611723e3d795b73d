// Which files a path names: a folder's, those of a DICOMDIR, or one.
#pragma once

#include <string>
#include <vector>

#include "storage/dicom/dicom_image.h"
#include "storage/types/volume_reader.h"

namespace voxweld {

// The images of the path, by the names of their files. Of a folder all files below are looked at,
// but for hidden ones; what is no DICOM image is passed over, with a warning.
// A DICOMDIR may name files in its folder and below, others only where spec.follow is set.
// InputError where there is no image, FormatError for one that is damaged.
std::vector<DicomImage> find_dicom_images(const InputSpec& spec,
                                          std::vector<std::string>& warnings);

}  // namespace voxweld
