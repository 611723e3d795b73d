// The lowest and highest of samples: in native byte order, of any alignment. Conservative where a double
// does not hold the value: lo is rounded down, hi up (64-bit integers beyond 2^53). -0 counts as 0.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <limits>
#include <span>
#include <type_traits>

#include "storage/types/sample_type.h"
#include "storage/types/volume.h"

namespace voxweld {

// Several running extremes side by side: floating minima may not be reordered by the compiler, and
// so would go one sample at a time. NaNs fail both comparisons.
template <class T>
class SampleRange {
 public:
  SampleRange() {
    lo_.fill(real ? Limits::infinity() : Limits::max());
    hi_.fill(real ? -Limits::infinity() : Limits::lowest());
  }

  void add(const std::byte* samples, std::size_t count) {
    std::size_t i = 0;
    for (; i + lanes <= count; i += lanes)
      for (std::size_t lane = 0; lane < lanes; ++lane) take(samples, i + lane, lane);
    for (; i < count; ++i) take(samples, i, 0);
  }

  ValueRange range() const {
    const T lo = *std::min_element(lo_.begin(), lo_.end());
    const T hi = *std::max_element(hi_.begin(), hi_.end());
    ValueRange range;
    range.any_nan = std::find(nan_.begin(), nan_.end(), true) != nan_.end();
    range.empty = lo > hi;  // nothing but NaNs, or nothing at all
    if (range.empty) return range;
    range.lo = rounded(lo, -HUGE_VAL);
    range.hi = rounded(hi, HUGE_VAL);
    return range;
  }

 private:
  static constexpr bool real = std::is_floating_point_v<T>;
  static constexpr std::size_t lanes = 64 / sizeof(T);
  using Limits = std::numeric_limits<T>;

  void take(const std::byte* samples, std::size_t i, std::size_t lane) {
    T v;
    std::memcpy(&v, samples + i * sizeof(T), sizeof v);
    lo_[lane] = v < lo_[lane] ? v : lo_[lane];
    hi_[lane] = v > hi_[lane] ? v : hi_[lane];
    if constexpr (real) nan_[lane] |= v != v;
  }
  // The nearest double that is not on the other side of it.
  static double rounded(T value, double towards) {
    const auto d = static_cast<double>(value);
    if constexpr (!real && sizeof(T) == 8) {
      const auto there = static_cast<__int128>(d), exact = static_cast<__int128>(value);
      if (towards < 0 ? there > exact : there < exact) return std::nextafter(d, towards);
    }
    return d + 0.0;
  }

  std::array<T, lanes> lo_, hi_;
  std::array<bool, lanes> nan_{};
};

// Of `part` among the samples of `held`, which holds it: x fastest.
inline ValueRange range_of(SampleType type, std::span<const std::byte> samples, const Box3& held,
                           const Box3& part) {
  return dispatch_sample_type(type, [&](auto tag) {
    using T = typename decltype(tag)::type;
    SampleRange<T> range;
    const Index3 size = held.size();
    for (std::int64_t z = part.lo.z; z < part.hi.z; ++z)
      for (std::int64_t y = part.lo.y; y < part.hi.y; ++y) {
        const Index3 at = Index3{part.lo.x, y, z} - held.lo;
        const auto first = static_cast<std::size_t>((at.z * size.y + at.y) * size.x + at.x);
        range.add(samples.data() + first * sizeof(T), static_cast<std::size_t>(part.size().x));
      }
    return range.range();
  });
}

}  // namespace voxweld
