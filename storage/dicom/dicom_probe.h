// How DICOM is told from other files and folders, without its module.
#pragma once

#include <cstddef>
#include <span>

#include "storage/types/volume_reader.h"

namespace voxweld {

// Whether a file's first bytes are those of DICOM: "DICM" at byte 128 or, without this preamble, a
// few data elements of group 2 or 8 one behind the other. 512 bytes are enough to tell.
bool looks_dicom(std::span<const std::byte> head);

// The row of the table: files, and folders among whose first files one is DICOM, also one level
// down. Opened by the module "dicom".
VolumeReader dicom_reader();

}  // namespace voxweld
