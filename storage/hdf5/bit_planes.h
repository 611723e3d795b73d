// The filter "bitshuffle": samples are cut into blocks, of each all bits of one place come together,
// and a block is then compressed by lz4.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace voxweld {

// values: of the filter in the file: its version (two), bytes a sample, samples a block or 0, and
// the compressor (none or 0; 2: lz4). Returns what is wrong, or an empty text.
// Precondition: values[2] > 0.
std::string decode_bit_planes(const std::vector<unsigned>& values,
                              std::span<const std::byte> stored, std::span<std::byte> out);

}  // namespace voxweld
