// Headerless samples: everything about them is the caller's to say.
#pragma once

#include <bit>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

#include "storage/readers/open_volume.h"
#include "storage/types/volume.h"

namespace voxweld {

struct RawLayout {
  std::filesystem::path path;
  Index3 size;  // samples along x (fastest), y, z
  SampleType type = SampleType::u8;
  std::endian byte_order = std::endian::little;
  std::int64_t header_bytes = 0;  // before the samples; -1: the samples end the file
  Vec3 spacing{1, 1, 1};
  std::string unit;
};

// Access::box. InputError for a bad layout; FormatError when the file is shorter than it says.
std::unique_ptr<SampleSource> open_raw(const RawLayout& layout);

// By name only: .raw and .bin.
Match sniff_raw(const InputProbe& probe);
// InputError when spec.raw lacks size or type.
std::unique_ptr<SampleSource> open_raw_spec(const InputSpec& spec);

}  // namespace voxweld
