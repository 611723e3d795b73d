// From samples as DICOM stores them to those of the machine.
#pragma once

#include <bit>
#include <cstddef>

#include "storage/dicom/dicom_image.h"

namespace voxweld {

// Turns `count` samples in place from `order` to the machine's, takes the stored ones of their bits
// (others may hold overlays) and, of signed ones, repeats the sign.
void settle_bits(std::byte* data, std::size_t count, const SampleBits& bits, std::endian order);

}  // namespace voxweld
