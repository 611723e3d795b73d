// Based on: M. E. Kounavis and F. L. Berry, "A Systematic Approach to Building High Performance
// Software-based CRC Generators", 2005 (eight tables, eight bytes a step).
#include "storage/store/crc32c.h"

#include <array>
#include <bit>
#include <cstring>

#if defined(__SSE4_2__)
#include <nmmintrin.h>
#endif

namespace voxweld {
namespace {

static_assert(std::endian::native == std::endian::little,
              "words are taken from memory as they lie");

std::uint64_t load_word(const std::byte* at) {
  std::uint64_t word = 0;
  std::memcpy(&word, at, sizeof word);
  return word;
}

#if defined(__SSE4_2__)
struct Crc {
  static std::uint32_t word(std::uint32_t crc, std::uint64_t word) {
    return static_cast<std::uint32_t>(_mm_crc32_u64(crc, word));
  }
  static std::uint32_t byte(std::uint32_t crc, std::byte byte) {
    return _mm_crc32_u8(crc, static_cast<unsigned char>(byte));
  }
};
#else
constexpr std::uint32_t polynomial = 0x82f63b78;
using Tables = std::array<std::array<std::uint32_t, 256>, 8>;

// tables[k][b]: the effect of byte b followed by k zero bytes.
constexpr Tables make_tables() {
  Tables tables{};
  for (std::uint32_t byte = 0; byte < 256; ++byte) {
    std::uint32_t crc = byte;
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ ((crc & 1) != 0 ? polynomial : 0);
    tables[0][byte] = crc;
  }
  for (std::size_t k = 1; k < 8; ++k)
    for (std::size_t byte = 0; byte < 256; ++byte) {
      const std::uint32_t before = tables[k - 1][byte];
      tables[k][byte] = (before >> 8) ^ tables[0][before & 0xff];
    }
  return tables;
}
constexpr Tables tables = make_tables();

struct Crc {
  static std::uint32_t word(std::uint32_t crc, std::uint64_t word) {
    word ^= crc;
    crc = 0;
    for (std::size_t k = 0; k < 8; ++k) crc ^= tables[7 - k][word >> (8 * k) & 0xff];
    return crc;
  }
  static std::uint32_t byte(std::uint32_t crc, std::byte byte) {
    return (crc >> 8) ^ tables[0][(crc ^ static_cast<std::uint32_t>(byte)) & 0xff];
  }
};
#endif

}  // namespace

std::uint32_t crc32c(std::span<const std::byte> data) {
  std::uint32_t crc = 0xffffffff;
  const std::byte* at = data.data();
  std::size_t left = data.size();
  for (; left >= 8; left -= 8, at += 8) crc = Crc::word(crc, load_word(at));
  for (; left > 0; --left, ++at) crc = Crc::byte(crc, *at);
  return ~crc;
}

}  // namespace voxweld
