// The compressors of chunks, undone.
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "storage/store/codec.h"

namespace voxweld {

// Fills `out`; what is wrong with `encoded`, or an empty text. Never writes beyond `out`, and takes
// no memory to speak of but for xz, whose dictionary is as large as what it decodes.
std::string decompress(const Compressor& compressor, std::span<const std::byte> encoded,
                       std::span<std::byte> out);

// gzip, zlib, or, where `bare`, deflate without a header.
std::string inflate_all(std::span<const std::byte> encoded, std::span<std::byte> out, bool bare);

}  // namespace voxweld
