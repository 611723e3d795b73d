// Which bin of a histogram a value falls into (storage/types/histogram.h).
//
// 8 and 16 bits: one bin for each value, so nothing is lost. Wider types: floating bins. The range
// of a volume is not known before its last sample, and bins chosen from what came first would make
// the histogram depend on the order; so the bin is the value itself, rounded to float32 and cut to
// sign, exponent and 11 bits of mantissa: 2^20 bins, each at most 1/2048 of its value wide, and one
// for each integer below 4096.
#pragma once

#include <bit>
#include <cstdint>
#include <limits>
#include <type_traits>

#include "storage/types/sample_type.h"

namespace voxweld {

namespace bins_detail {
constexpr int dropped_bits = 12;  // of a float32's 32
constexpr std::uint32_t sign_bit = 0x80000000;

// Ascends with the value; -0 and 0 are one.
constexpr std::uint32_t ascending_key(float value) {
  const auto bits = std::bit_cast<std::uint32_t>(value + 0.0f);
  return (bits & sign_bit) != 0 ? ~bits : bits | sign_bit;
}
}  // namespace bins_detail

// Precondition: value is not NaN.
template <class T>
constexpr std::uint32_t histogram_bin(T value) {
  if constexpr (sizeof(T) <= 2) {
    return static_cast<std::uint32_t>(static_cast<std::int32_t>(value) -
                                      static_cast<std::int32_t>(std::numeric_limits<T>::min()));
  } else if constexpr (std::is_same_v<T, double>) {
    // Finite stays finite, so that infinities have bins of their own.
    constexpr double most = std::numeric_limits<float>::max();
    const bool infinite = value - value != 0;
    const double cut = infinite || (value <= most && value >= -most) ? value
                       : value > 0                                   ? most
                                                                     : -most;
    return bins_detail::ascending_key(static_cast<float>(cut)) >> bins_detail::dropped_bits;
  } else {
    return bins_detail::ascending_key(static_cast<float>(value)) >> bins_detail::dropped_bits;
  }
}

// A value of that bin: the only one where there is one, else the one nearest zero, which integers
// below 4096 and short fractions are exactly. Precondition: bin < histogram_bins(type).
double histogram_bin_value(SampleType type, std::uint32_t bin);

}  // namespace voxweld
