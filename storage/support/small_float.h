// Floats of fewer bits than 32, in the form of IEEE 754, which every float holds exactly.
#pragma once

#include <bit>
#include <cstdint>

namespace voxweld {

// A sign, then the exponent's bits, then the mantissa's, which are the lowest. Preconditions: at most
// 7 and 22 of them, and nothing above the sign.
template <int ExponentBits, int MantissaBits>
constexpr float float_of_small(std::uint32_t bits) {
  constexpr std::uint32_t largest = (1U << ExponentBits) - 1, bias = largest >> 1, wide_bias = 127;
  const std::uint32_t sign = bits >> (ExponentBits + MantissaBits) << 31;
  const std::uint32_t exponent = bits >> MantissaBits & largest;
  const std::uint32_t mantissa = bits & ((1U << MantissaBits) - 1);
  if (exponent == 0) {  // 0 and what is too small to be normal: multiples of the least
    constexpr auto least = std::bit_cast<float>((wide_bias + 1 - bias - MantissaBits) << 23);
    const float value = static_cast<float>(mantissa) * least;
    return sign != 0 ? -value : value;
  }
  const std::uint32_t wide = exponent == largest ? 255 : exponent + wide_bias - bias;
  return std::bit_cast<float>(sign | wide << 23 | mantissa << (23 - MantissaBits));
}

// IEEE 754 binary16.
constexpr float float_of_half(std::uint16_t half) {
  return float_of_small<5, 10>(half);
}

}  // namespace voxweld
