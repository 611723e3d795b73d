#include "stages/ingest/histogram_values.h"

#include <algorithm>
#include <cmath>

#include "stages/ingest/histogram_bins.h"

namespace voxweld {
namespace {

// The stored values that fall into the bin, as an interval.
struct StoredBin {
  double lo, hi;
};

StoredBin stored_bin(SampleType type, std::uint32_t bin) {
  const double value = histogram_bin_value(type, bin);
  const bool real = type == SampleType::f32 || type == SampleType::f64;
  // A bin's value is its end nearest 0, and the bin next to it begins at the other.
  const std::uint32_t next = value < 0 ? bin - 1 : bin + 1;
  const bool last = value < 0 ? bin == 0 : next >= histogram_bins(type);
  const double end = sample_bytes(type) <= 2 || last ? value : histogram_bin_value(type, next);
  const double lo = std::min(value, end), hi = std::isfinite(end) ? std::max(value, end) : value;
  if (!real && hi - lo <= 1) return {value - 0.5, value + 0.5};
  return {lo, hi};
}

}  // namespace

std::vector<ValueCount> finite_values(const Histogram& histogram, const ValueScale& scale) {
  std::vector<ValueCount> values;
  values.reserve(histogram.bins.size());
  for (const HistogramBin& bin : histogram.bins) {
    const double value = scale.real(histogram_bin_value(histogram.type, bin.bin));
    if (!std::isfinite(value)) continue;
    const StoredBin stored = stored_bin(histogram.type, bin.bin);
    const double a = scale.real(stored.lo), b = scale.real(stored.hi);
    values.push_back({value, static_cast<double>(bin.count), std::min(a, b), std::max(a, b)});
  }
  if (scale.slope < 0) std::reverse(values.begin(), values.end());
  return values;
}

std::optional<double> quantile_of(std::span<const ValueCount> values, double q) {
  if (values.empty()) return std::nullopt;
  double total = 0, seen = 0;
  for (const ValueCount& v : values) total += v.count;
  for (const ValueCount& v : values) {
    seen += v.count;
    if (seen >= q * total) return v.value;
  }
  return values.back().value;
}

}  // namespace voxweld
