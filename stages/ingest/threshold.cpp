// Based on: N. Otsu, "A Threshold Selection Method from Gray-Level Histograms", IEEE Transactions
// on Systems, Man, and Cybernetics 9(1), 1979. Differs in that the threshold lies halfway between
// the two classes' nearest values, so that an empty stretch of the histogram is cut in its middle.
#include "stages/ingest/threshold.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "stages/ingest/histogram_bins.h"
#include "stages/ingest/histogram_values.h"
#include "stages/ingest/valley.h"
#include "storage/types/isovalue.h"

namespace voxweld {
namespace {

struct Moments {
  double count = 0, mean = 0, squares = 0;  // squares: of the distances from the mean

  // B. P. Welford, "Note on a Method for Calculating Corrected Sums of Squares and Products", 1962.
  void add(const ValueCount& v) {
    count += v.count;
    const double step = v.value - mean;
    mean += step * (v.count / count);
    squares += step * (v.value - mean) * v.count;
  }
};

std::optional<Threshold> otsu(std::span<const ValueCount> values) {
  if (values.size() < 2) return std::nullopt;
  Moments all;
  for (const ValueCount& v : values) all.add(v);
  Moments below;
  double best = -1;
  Threshold threshold;
  for (std::size_t i = 0; i + 1 < values.size(); ++i) {
    below.add(values[i]);
    // w0 w1 (m1 - m0)^2 written with the mean of all: w0 / w1 (m0 - m)^2.
    const double w0 = below.count / all.count, w1 = 1 - w0;
    const double distance = below.mean - all.mean;
    const double between = w1 > 0 ? w0 / w1 * distance * distance : 0;
    if (between <= best) continue;
    best = between;
    threshold.value = 0.5 * values[i].value + 0.5 * values[i + 1].value;
  }
  const double total = all.squares / all.count;
  threshold.separability = total > 0 ? std::fmin(1, best / total) : 0;
  return threshold;
}

constexpr double least_padding = 0.01;      // share of the samples
constexpr double least_gap = 0.25;          // of the spread of the others
constexpr double least_separability = 0.8;  // of the others: clearly two classes

// Whether `extreme` is padding beside `rest`, whose nearest value is `next`.
bool is_padding(const ValueCount& extreme, double next, std::span<const ValueCount> rest) {
  double others = 0;
  for (const ValueCount& v : rest) others += v.count;
  if (extreme.count < least_padding * (extreme.count + others)) return false;
  const double spread = *quantile_of(rest, 0.999) - *quantile_of(rest, 0.001);
  if (std::abs(next - extreme.value) < least_gap * spread) return false;
  const auto cut = otsu(rest);
  return cut && cut->separability >= least_separability;
}

}  // namespace

std::optional<Threshold> otsu_threshold(const Histogram& histogram, const ValueScale& scale) {
  return otsu(finite_values(histogram, scale));
}

std::optional<double> quantile(const Histogram& histogram, double q, const ValueScale& scale) {
  return quantile_of(finite_values(histogram, scale), q);
}

std::string no_threshold_text(const Histogram& histogram, const ValueScale& scale) {
  std::vector<HistogramBin> bins = histogram.bins;
  std::erase_if(bins, [&](const HistogramBin& bin) {
    return !std::isfinite(histogram_bin_value(histogram.type, bin.bin));
  });
  if (bins.empty()) return histogram.bins.empty() ? "are NaN" : "are no finite numbers";
  const double value = histogram_bin_value(histogram.type, bins.front().bin);
  if (sample_bytes(histogram.type) <= 2)
    return fmt::format("have one value, {}", scale.real(value));
  // A bin's value is its end nearest 0.
  const std::uint32_t next = value < 0 ? bins.front().bin - 1 : bins.front().bin + 1;
  const double end = histogram_bin_value(histogram.type, next);
  const bool integers = histogram.type != SampleType::f32 && histogram.type != SampleType::f64;
  if (integers && std::abs(end - value) <= 1)
    return fmt::format("have one value, {}", scale.real(value));
  const double a = scale.real(value), b = scale.real(end);
  return fmt::format("have one value or lie too close together for a histogram: from {} to {}",
                     isovalue_text(std::min(a, b)), isovalue_text(std::max(a, b)));
}

std::optional<IsovalueSuggestion> suggest_isovalue(const Histogram& histogram,
                                                   const ValueScale& scale, IsovalueRule rule) {
  const std::vector<ValueCount> values = finite_values(histogram, scale);
  std::span<const ValueCount> rest = values;
  IsovalueSuggestion suggestion;
  if (rest.size() > 2 && is_padding(rest.front(), rest[1].value, rest.subspan(1))) {
    suggestion.padding = rest.front().value;
    rest = rest.subspan(1);
  } else if (rest.size() > 2 &&
             is_padding(rest.back(), rest[rest.size() - 2].value, rest.first(rest.size() - 1))) {
    suggestion.padding = rest.back().value;
    rest = rest.first(rest.size() - 1);
  }
  const auto threshold = rule == IsovalueRule::otsu ? otsu(rest) : deepest_valley(rest);
  if (!threshold) return std::nullopt;
  suggestion.threshold = *threshold;
  return suggestion;
}

}  // namespace voxweld
