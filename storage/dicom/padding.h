// Samples that stand for places outside of the scanned field (PixelPaddingValue and
// PixelPaddingRangeLimit, PS3.3 C.7.5.1.1.2).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "storage/dicom/dicom_image.h"

namespace voxweld {

struct Padding {
  std::int64_t lo = 0, hi = 0;  // stored samples, both included
  // They are in the upper half of what the samples can be, so that an isosurface would take them
  // for material.
  bool high = false;
  std::int64_t lowest = 0;  // that a sample can be
};

// Nothing where the image names none.
std::optional<Padding> padding_of(const DicomImage& image);

// Replaces samples of such a high padding by the lowest value, which is outside of any surface.
// data: `count` samples of that type, native byte order.
void lower_padding(std::byte* data, std::size_t count, SampleType type, const Padding& padding);

}  // namespace voxweld
