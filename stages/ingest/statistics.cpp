#include "stages/ingest/statistics.h"

#include <algorithm>
#include <cstring>

#include "stages/ingest/histogram_bins.h"
#include "storage/types/sample_range.h"

namespace voxweld {
namespace {

template <class T>
T load(const std::byte* at) {
  T value;
  std::memcpy(&value, at, sizeof value);
  return value;
}

}  // namespace

HistogramStatistics::HistogramStatistics(SampleType type)
    : type_(type), counts_(histogram_bins(type)), lowest_(histogram_bins(type)), highest_(0) {}

ValueRange HistogramStatistics::add(std::span<const std::byte> samples) {
  return dispatch_sample_type(type_, [&](auto tag) {
    using T = typename decltype(tag)::type;
    const std::size_t count = samples.size() / sizeof(T);
    SampleRange<T> extremes;
    extremes.add(samples.data(), count);
    const ValueRange range = extremes.range();
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
