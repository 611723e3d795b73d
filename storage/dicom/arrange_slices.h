// The order and places of slices: by position along the normal, never by name or number.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "storage/dicom/choose_series.h"
#include "storage/types/volume_reader.h"

namespace voxweld {

struct SliceStack {
  std::vector<DicomSlice> slices;  // by rising position, each place once
  std::int64_t planes = 0;         // of the volume; as many as slices unless these are interpolated
  // Where the slices lie, counted in planes, rising from 0; empty where each plane is a slice.
  std::vector<double> at;
};

// Whether the samples of both are the same.
using SamePixels = std::function<bool(const DicomSlice&, const DicomSlice&)>;

// Sets info.geometry, with the third axis the real step from slice to slice, also where that is not
// along the normal. FormatError for slices that are no volume: without positions, several different
// ones at one place, shifted sideways or, unless spec.resample is uniform, not equally far apart.
// Precondition: the group's images have no objection.
SliceStack arrange_slices(const std::vector<DicomImage>& images, const DicomGroup& group,
                          const InputSpec& spec, const SamePixels& same, VolumeInfo& info);

}  // namespace voxweld
