#include "storage/image/tiff_samples.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <type_traits>

#include "storage/support/small_float.h"

namespace voxweld {
namespace {

constexpr int unsigned_format = 1, signed_format = 2, float_format = 3, unknown_format = 4;

// The sample at `index` of a stream of samples of so many bits.
std::uint64_t packed_bits(const std::byte* row, std::size_t index, int bits) {
  std::uint64_t at = static_cast<std::uint64_t>(index) * static_cast<std::uint64_t>(bits);
  std::uint64_t value = 0;
  for (int left = bits; left > 0;) {
    const int unread = 8 - static_cast<int>(at % 8);
    const int take = std::min(unread, left);
    const auto byte = std::to_integer<unsigned>(row[at / 8]);
    value = (value << take) | ((byte >> (unread - take)) & ((1U << take) - 1));
    at += static_cast<std::uint64_t>(take);
    left -= take;
  }
  return value;
}

template <class U>
U loaded(const std::byte* row, std::size_t index) {
  U value;
  std::memcpy(&value, row + index * sizeof(U), sizeof(U));
  return value;
}

std::uint64_t three_bytes(const std::byte* row, std::size_t index) {
  const std::byte* at = row + 3 * index;
  const auto byte = [&](int i) { return std::to_integer<std::uint64_t>(at[i]); };
  return std::endian::native == std::endian::little ? byte(0) | byte(1) << 8 | byte(2) << 16
                                                    : byte(2) | byte(1) << 8 | byte(0) << 16;
}

std::uint64_t stored_bits_of(const std::byte* row, std::size_t index, const TiffSampleTags& tags) {
  switch (tags.bits) {
    case 8:
      return loaded<std::uint8_t>(row, index);
    case 16:
      return loaded<std::uint16_t>(row, index);
    case 32:
      return loaded<std::uint32_t>(row, index);
    case 64:
      return loaded<std::uint64_t>(row, index);
    default:
      return tags.format == float_format ? three_bytes(row, index)
                                         : packed_bits(row, index, tags.bits);
  }
}

template <class T>
T converted(const TiffCoding& coding, std::uint64_t stored) {
  const int bits = coding.tags.bits;
  if constexpr (std::is_same_v<T, float>) {
    const auto low = static_cast<std::uint32_t>(stored);
    if (bits == 16) return float_of_small<5, 10>(low);
    return bits == 24 ? float_of_small<7, 16>(low) : std::bit_cast<float>(low);
  } else if constexpr (std::is_same_v<T, double>) {
    return std::bit_cast<double>(stored);
  } else if constexpr (std::is_signed_v<T>) {
    const int spare = 64 - bits;
    return static_cast<T>(static_cast<std::int64_t>(stored << spare) >> spare);
  } else {
    const std::uint64_t top = ~std::uint64_t{0} >> (64 - bits);
    return static_cast<T>(coding.white_is_zero ? top - stored : stored);
  }
}

}  // namespace

std::optional<SampleType> tiff_sample_type(const TiffSampleTags& tags) {
  const int bits = tags.bits;
  if (tags.format == float_format) {
    if (bits == 64) return SampleType::f64;
    return bits == 16 || bits == 24 || bits == 32 ? std::optional(SampleType::f32) : std::nullopt;
  }
  const bool is_signed = tags.format == signed_format;
  if (!is_signed && tags.format != unsigned_format && tags.format != unknown_format)
    return std::nullopt;
  if (bits < 1 || (bits > 32 && bits != 64)) return std::nullopt;
  if (bits <= 8) return is_signed ? SampleType::i8 : SampleType::u8;
  if (bits <= 16) return is_signed ? SampleType::i16 : SampleType::u16;
  if (bits <= 32) return is_signed ? SampleType::i32 : SampleType::u32;
  return is_signed ? SampleType::i64 : SampleType::u64;
}

void convert_tiff_run(const TiffCoding& coding, const std::byte* row, const TiffRun& run,
                      std::byte* out, std::size_t out_step) {
  dispatch_sample_type(coding.type, [&](auto tag) {
    using T = typename decltype(tag)::type;
    const bool as_it_is = coding.tags.bits == static_cast<int>(8 * sizeof(T)) &&
                          !(coding.white_is_zero && std::is_unsigned_v<T>);
    if (as_it_is && run.step == 1 && out_step == 1) {
      std::memcpy(out, row + run.first * sizeof(T), run.count * sizeof(T));
      return;
    }
    for (std::size_t i = 0; i < run.count; ++i) {
      const std::size_t index = run.first + i * run.step;
      const T value = as_it_is ? loaded<T>(row, index)
                               : converted<T>(coding, stored_bits_of(row, index, coding.tags));
      std::memcpy(out + i * out_step * sizeof(T), &value, sizeof(T));
    }
  });
}

}  // namespace voxweld
