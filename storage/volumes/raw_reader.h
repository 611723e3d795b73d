// Headerless samples: everything about them is the caller's to say.
#pragma once

#include <bit>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

#include "storage/types/volume_reader.h"

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

// Told by name only: .raw and .bin. InputError where the spec's raw pieces lack size or type.
VolumeReader raw_reader();

}  // namespace voxweld
