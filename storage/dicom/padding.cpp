#include "storage/dicom/padding.h"

#include <algorithm>
#include <cstring>

namespace voxweld {

std::optional<Padding> padding_of(const DicomImage& image) {
  if (!image.padding) return std::nullopt;
  const std::int64_t limit = image.padding_limit.value_or(*image.padding);
  const std::int64_t half = std::int64_t{1} << (image.bits.stored - 1);
  Padding padding;
  padding.lo = std::min(*image.padding, limit);
  padding.hi = std::max(*image.padding, limit);
  padding.high = padding.hi >= (image.bits.is_signed ? 1 : half);
  padding.lowest = image.bits.is_signed ? -half : 0;
  return padding;
}

void lower_padding(std::byte* data, std::size_t count, SampleType type, const Padding& padding) {
  dispatch_sample_type(type, [&](auto tag) {
    using T = typename decltype(tag)::type;
    const auto lo = static_cast<double>(padding.lo), hi = static_cast<double>(padding.hi);
    const auto lowest = static_cast<T>(padding.lowest);
    for (std::size_t i = 0; i < count; ++i) {
      T value;
      std::memcpy(&value, data + i * sizeof(T), sizeof(T));
      const auto v = static_cast<double>(value);
      if (v >= lo && v <= hi) std::memcpy(data + i * sizeof(T), &lowest, sizeof(T));
    }
  });
}

}  // namespace voxweld
