// The histogram of a part of a volume. Bins are fixed by the sample type alone (stages/ingest says
// how), so histograms of parts add up exactly, in any order.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "storage/types/sample_type.h"

namespace voxweld {

// How many bins there are: one for each value of 8 and 16 bits, floating bins for the others.
constexpr std::uint32_t histogram_bins(SampleType type) {
  const bool narrow = type == SampleType::u8 || type == SampleType::i8;
  const bool wide = type != SampleType::u16 && type != SampleType::i16;
  return std::uint32_t{1} << (narrow ? 8 : wide ? 20 : 16);
}

struct HistogramBin {
  std::uint32_t bin = 0;    // < histogram_bins(type), ascending with the value
  std::uint64_t count = 0;  // positive
  friend bool operator==(const HistogramBin&, const HistogramBin&) = default;
};

struct Histogram {
  SampleType type = SampleType::u8;
  std::vector<HistogramBin> bins;  // ascending
  std::uint64_t nans = 0;          // samples in no bin
  friend bool operator==(const Histogram&, const Histogram&) = default;
};

// Adds `part` to `sum`. Exact: the order of the parts does not matter. Precondition: same type.
inline void add(Histogram& sum, const Histogram& part) {
  std::vector<HistogramBin> bins;
  bins.reserve(sum.bins.size() + part.bins.size());
  auto a = sum.bins.begin();
  for (const HistogramBin& b : part.bins) {
    while (a != sum.bins.end() && a->bin < b.bin) bins.push_back(*a++);
    bins.push_back(b);
    if (a != sum.bins.end() && a->bin == b.bin) bins.back().count += a++->count;
  }
  bins.insert(bins.end(), a, sum.bins.end());
  sum.bins = std::move(bins);
  sum.nans += part.nans;
}

}  // namespace voxweld
