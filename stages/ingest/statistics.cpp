#include "stages/ingest/statistics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>

#include "stages/ingest/histogram_bins.h"

namespace voxweld {
namespace {

template <class T>
T load(const std::byte* at) {
  T value;
  std::memcpy(&value, at, sizeof value);
  return value;
}

// The nearest doubles not above and not below.
template <class T>
double rounded_down(T value) {
  const auto d = static_cast<double>(value);
  if constexpr (std::is_integral_v<T> && sizeof(T) == 8)
    if (static_cast<__int128>(d) > static_cast<__int128>(value))
      return std::nextafter(d, -INFINITY);
  return d + 0.0;
}
template <class T>
double rounded_up(T value) {
  const auto d = static_cast<double>(value);
  if constexpr (std::is_integral_v<T> && sizeof(T) == 8)
    if (static_cast<__int128>(d) < static_cast<__int128>(value)) return std::nextafter(d, INFINITY);
  return d + 0.0;
}

template <class T>
struct Extremes {
  T lo, hi;
  bool any_nan = false;
};

// Several running extremes side by side: floating minima may not be reordered by the compiler, and
// so would go one sample at a time. NaNs fail both comparisons.
template <class T>
Extremes<T> extremes(std::span<const std::byte> samples) {
  constexpr bool real = std::is_floating_point_v<T>;
  constexpr std::size_t lanes = 64 / sizeof(T);
  using Limits = std::numeric_limits<T>;
  std::array<T, lanes> lo, hi;
  std::array<bool, lanes> nan{};
  lo.fill(real ? Limits::infinity() : Limits::max());
  hi.fill(real ? -Limits::infinity() : Limits::lowest());
  const std::size_t count = samples.size() / sizeof(T);
  const auto take = [&](std::size_t i, std::size_t lane) {
    const T v = load<T>(samples.data() + i * sizeof(T));
    lo[lane] = v < lo[lane] ? v : lo[lane];
    hi[lane] = v > hi[lane] ? v : hi[lane];
    if constexpr (real) nan[lane] |= v != v;
  };
  std::size_t i = 0;
  for (; i + lanes <= count; i += lanes)
    for (std::size_t lane = 0; lane < lanes; ++lane) take(i + lane, lane);
  for (; i < count; ++i) take(i, 0);
  return {*std::min_element(lo.begin(), lo.end()), *std::max_element(hi.begin(), hi.end()),
          std::find(nan.begin(), nan.end(), true) != nan.end()};
}

template <class T>
ValueRange range_of(std::span<const std::byte> samples) {
  if (samples.empty()) return {};
  const Extremes<T> found = extremes<T>(samples);
  ValueRange range;
  range.any_nan = found.any_nan;
  range.empty = found.lo > found.hi;  // nothing but NaNs
  if (range.empty) return range;
  range.lo = rounded_down(found.lo);
  range.hi = rounded_up(found.hi);
  return range;
}

}  // namespace

HistogramStatistics::HistogramStatistics(SampleType type)
    : type_(type), counts_(histogram_bins(type)), lowest_(histogram_bins(type)), highest_(0) {}

ValueRange HistogramStatistics::add(std::span<const std::byte> samples) {
  return dispatch_sample_type(type_, [&](auto tag) {
    using T = typename decltype(tag)::type;
    const ValueRange range = range_of<T>(samples);
    const std::size_t count = samples.size() / sizeof(T);
    if (range.empty) {
      nans_ += count;
      return range;
    }
    std::uint64_t nans = 0;
    if (range.lo == range.hi && !range.any_nan) {  // empty space, mostly: no need to count it out
      const std::uint32_t bin = histogram_bin(load<T>(samples.data()));
      counts_[bin] += count;
      lowest_ = std::min(lowest_, bin);
      highest_ = std::max(highest_, bin);
      return range;
    }
    std::uint32_t lowest = lowest_, highest = highest_;
    for (std::size_t i = 0; i < count; ++i) {
      const T value = load<T>(samples.data() + i * sizeof(T));
      if (value != value) {
        ++nans;
        continue;
      }
      const std::uint32_t bin = histogram_bin(value);
      lowest = std::min(lowest, bin);
      highest = std::max(highest, bin);
      ++counts_[bin];
    }
    lowest_ = lowest;
    highest_ = highest;
    nans_ += nans;
    return range;
  });
}

Histogram HistogramStatistics::take() {
  Histogram histogram;
  histogram.type = type_;
  histogram.nans = nans_;
  for (std::uint32_t bin = lowest_; bin <= highest_ && bin < counts_.size(); ++bin)
    if (counts_[bin] > 0) {
      histogram.bins.push_back({bin, counts_[bin]});
      counts_[bin] = 0;
    }
  lowest_ = static_cast<std::uint32_t>(counts_.size());
  highest_ = 0;
  nans_ = 0;
  return histogram;
}

}  // namespace voxweld
