// From images to volumes: what belongs together, and which of several is read.
#pragma once

#include <cstddef>
#include <vector>

#include "storage/dicom/dicom_image.h"
#include "storage/types/volume_reader.h"

namespace voxweld {

// One frame of one image.
struct DicomSlice {
  std::size_t image = 0;
  std::size_t frame = 0;
};

// Frames of one series that agree in size, samples, orientation, spacing and stack; by image and
// frame.
struct DicomGroup {
  std::vector<DicomSlice> slices;
};

// By the number of the series, its UID, then by the first file of each group.
std::vector<DicomGroup> group_slices(const std::vector<DicomImage>& images);

// The group that spec.select.series names: a UID, or the number of a group in the list, from 1.
// Where it is open: the only one that can be a volume, which localizers, colours and samples that
// are not read cannot. Of several groups all are listed in info.choices, and those left aside in a
// warning. InputError, with the list, where none or several remain; with spec.survey the first is
// taken then.
std::size_t choose_group(const std::vector<DicomImage>& images,
                         const std::vector<DicomGroup>& groups, const InputSpec& spec,
                         VolumeInfo& info);

}  // namespace voxweld
