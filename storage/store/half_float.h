// 16-bit floats (IEEE 754 binary16), which every float holds exactly.
#pragma once

#include <bit>
#include <cstdint>

namespace voxweld {

constexpr float float_of_half(std::uint16_t half) {
  const std::uint32_t sign = static_cast<std::uint32_t>(half & 0x8000U) << 16;
  const std::uint32_t exponent = half >> 10 & 0x1fU, mantissa = half & 0x3ffU;
  if (exponent == 0) {  // 0 and what is too small to be normal: mantissa * 2^-24
    const float value = static_cast<float>(mantissa) * 0x1p-24F;
    return sign != 0 ? -value : value;
  }
  const std::uint32_t wide = exponent == 31 ? 255 : exponent + 112;
  return std::bit_cast<float>(sign | wide << 23 | mantissa << 13);
}

}  // namespace voxweld
