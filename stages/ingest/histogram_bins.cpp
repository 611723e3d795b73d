#include "stages/ingest/histogram_bins.h"

#include <cmath>

namespace voxweld {

double histogram_bin_value(SampleType type, std::uint32_t bin) {
  return dispatch_sample_type(type, [&](auto tag) -> double {
    using T = typename decltype(tag)::type;
    if constexpr (sizeof(T) <= 2) {
      return static_cast<double>(bin) + static_cast<double>(std::numeric_limits<T>::min());
    } else {
      const std::uint32_t low = bin << bins_detail::dropped_bits;
      const bool negative = (low & bins_detail::sign_bit) == 0;
      const std::uint32_t dropped = (std::uint32_t{1} << bins_detail::dropped_bits) - 1;
      const std::uint32_t bits = negative ? ~(low | dropped) : low ^ bins_detail::sign_bit;
      const double value = std::bit_cast<float>(bits);
      // The integers of a bin lie away from zero of its first value.
      return std::is_integral_v<T> ? (negative ? std::floor(value) : std::ceil(value)) : value;
    }
  });
}

}  // namespace voxweld
