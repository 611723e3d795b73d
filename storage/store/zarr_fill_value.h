// Zarr v3 fill values: numbers, "NaN", "Infinity", "-Infinity" and hexadecimal bit patterns.
#pragma once

#include <array>
#include <cstddef>

#include "storage/store/zarr_json.h"
#include "storage/types/sample_type.h"

namespace voxweld {

// One sample in native byte order; FormatError where the value is none of `type`.
std::array<std::byte, 8> parse_fill_value(const JsonField& field, SampleType type);

}  // namespace voxweld
