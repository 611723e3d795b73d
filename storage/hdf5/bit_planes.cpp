#include "storage/hdf5/bit_planes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <cstring>

#include "storage/support/byte_order.h"
#include "storage/support/lz4_block.h"

namespace voxweld {
namespace {

constexpr std::size_t eight = 8;  // samples share the bytes of a plane
constexpr std::size_t header_bytes = 12;

// The 8 x 8 bits of a word turned about their diagonal: byte i holds bit i of each byte.
std::uint64_t transposed(std::uint64_t bits) {
  const auto swap = [&](std::uint64_t mask, int shift) {
    const std::uint64_t t = (bits ^ (bits >> shift)) & mask;
    bits ^= t ^ (t << shift);
  };
  swap(0x00aa00aa00aa00aaULL, 7);
  swap(0x0000cccc0000ccccULL, 14);
  swap(0x00000000f0f0f0f0ULL, 28);
  return bits;
}

// in: 8 * width planes of count / 8 bytes. Precondition: count is a multiple of 8.
void join_planes(const std::byte* in, std::size_t count, std::size_t width, std::byte* out) {
  const std::size_t plane = count / eight;
  for (std::size_t byte = 0; byte < width; ++byte)
    for (std::size_t group = 0; group < plane; ++group) {
      std::uint64_t bits = 0;
      for (std::size_t bit = 0; bit < eight; ++bit)
        bits |= std::to_integer<std::uint64_t>(in[(byte * eight + bit) * plane + group])
                << (eight * bit);
      bits = transposed(bits);
      for (std::size_t i = 0; i < eight; ++i)
        out[(group * eight + i) * width + byte] = static_cast<std::byte>(bits >> (eight * i));
    }
}

// As the filter chooses it: 8 KiB, in whole eights.
std::size_t usual_block(std::size_t width) {
  return std::max<std::size_t>(128, 8192 / width / eight * eight);
}

}  // namespace

std::string decode_bit_planes(const std::vector<unsigned>& values,
                              std::span<const std::byte> stored, std::span<std::byte> out) {
  const std::size_t width = values[2];
  const bool packed = values.size() >= 5 && values[4] != 0;
  std::size_t block = values.size() >= 4 && values[3] != 0 ? values[3] : usual_block(width);
  if (packed) {
    if (stored.size() < header_bytes) return "its bitshuffle header is cut short";
    const auto total = load_as<std::uint64_t>(stored.data(), 0, std::endian::big);
    block = load_as<std::uint32_t>(stored.data(), 8, std::endian::big) / width;
    if (total != out.size())
      return fmt::format("its bitshuffle header speaks of {} bytes, {} expected", total,
                         out.size());
    stored = stored.subspan(header_bytes);
  }
  if (block == 0 || block % eight != 0 || block > (std::size_t{1} << 28) / width)
    return fmt::format("its bitshuffle blocks are of {} samples", block);
  std::vector<std::byte> planes;
  // Whole blocks, then one of what is left in whole eights, then single samples as they are.
  while (out.size() / width >= eight) {
    const std::size_t count = std::min(block, out.size() / width / eight * eight);
    std::size_t bytes = count * width;
    const std::byte* from = stored.data();
    if (packed) {
      if (stored.size() < 4) return "its bitshuffle blocks are cut short";
      const auto length = load_as<std::uint32_t>(stored.data(), 0, std::endian::big);
      if (length > stored.size() - 4) return "its bitshuffle blocks are cut short";
      planes.resize(bytes);
      if (!lz4_decode_block(stored.subspan(4, length), planes))
        return "its bitshuffle data is damaged";
      from = planes.data();
      stored = stored.subspan(4 + std::size_t{length});
    } else if (stored.size() < bytes) {
      return "its bitshuffle blocks are cut short";
    } else {
      stored = stored.subspan(bytes);
    }
    join_planes(from, count, width, out.data());
    out = out.subspan(bytes);
  }
  if (stored.size() < out.size()) return "its bitshuffle blocks are cut short";
  std::memcpy(out.data(), stored.data(), out.size());
  return {};
}

}  // namespace voxweld
