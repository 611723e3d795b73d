// One block of lz4, undone. For those that link liblz4.
#pragma once

#include <lz4.h>

#include <cstddef>
#include <limits>
#include <span>
#include <utility>

namespace voxweld {

// Whether the block decodes to exactly as many bytes as `out` has; else what is in it is left open.
inline bool lz4_decode_block(std::span<const std::byte> block, std::span<std::byte> out) {
  constexpr std::size_t most = std::numeric_limits<int>::max();
  if (block.size() > most || out.size() > most) return false;
  const int got = LZ4_decompress_safe(reinterpret_cast<const char*>(block.data()),
                                      reinterpret_cast<char*>(out.data()),
                                      static_cast<int>(block.size()), static_cast<int>(out.size()));
  return std::cmp_equal(got, out.size());
}

}  // namespace voxweld
