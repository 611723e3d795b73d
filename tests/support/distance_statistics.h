// Mean, percentiles and maximum of very many distances, the same whatever the threads.
#pragma once

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <vector>

namespace voxweld {

// In voxels; all zero when count is.
struct DistanceStatistics {
  double max = 0;
  double mean = 0;
  double p99 = 0;   // 99 of 100 distances are at most this; rounded up by at most 1 part in 1024
  double p999 = 0;  // the same of 999 of 1000
  std::uint64_t count = 0;
};

// Every distance counting the same, and counting as much as it weighs.
struct WeighedStatistics {
  DistanceStatistics plain, by_weight;
};

// Distances by size, in bins of 1/1024 of their value: bin = the upper bits of the float. Counts
// and weights are integers, so adding them up gives the same in any order.
class DistanceBins {
 public:
  DistanceBins() : totals_(bins) {}

  void add(double distance, std::uint64_t weight) {
    totals_[std::bit_cast<std::uint32_t>(static_cast<float>(distance)) >> dropped_bits] += weight;
  }
  void add(const DistanceBins& other) {
    for (std::size_t i = 0; i < bins; ++i) totals_[i] += other.totals_[i];
  }
  // The least value that all but one part in `parts` of the weight is at most.
  double all_but(std::uint64_t parts) const {
    std::uint64_t all = 0, reached = 0;
    for (const std::uint64_t t : totals_) all += t;
    for (std::size_t bin = 0; bin < bins; ++bin)
      if ((reached += totals_[bin]) >= all - all / parts) return upper_end(bin);
    return 0;
  }

 private:
  static constexpr int dropped_bits = 13;
  static constexpr std::size_t bins = std::size_t{1} << (31 - dropped_bits);

  static double upper_end(std::size_t bin) {
    return std::bit_cast<float>(static_cast<std::uint32_t>((bin + 1) << dropped_bits) - 1);
  }

  std::vector<std::uint64_t> totals_;
};

// What a block of items adds up to.
struct DistanceTotals {
  double sum = 0, weight = 0, max = 0;

  void add(double distance, double by) {
    sum += distance * by;
    weight += by;
    if (by > 0) max = std::max(max, distance);
  }
  void add(const DistanceTotals& other) {
    sum += other.sum;
    weight += other.weight;
    max = std::max(max, other.max);
  }
  DistanceStatistics with(const DistanceBins& bins, std::uint64_t count) const {
    if (weight <= 0) return {.count = count};
    return {max, sum / weight, std::min(bins.all_but(100), max), std::min(bins.all_but(1000), max),
            count};
  }
};

// Statistics of per_item distances for each of `items` items: measure(item, out) fills them, and
// returns what each of them weighs, not negative.
template <std::size_t per_item, class F>
WeighedStatistics distance_statistics(std::size_t items, F&& measure) {
  struct Totals {
    DistanceTotals plain, by_weight;
  };
  struct Bins {
    DistanceBins plain, by_weight;
  };
  // Sums of reals depend on their order, so each fixed block of items keeps its own.
  constexpr std::size_t block = 1024;
  const std::size_t blocks = (items + block - 1) / block;
  std::vector<Totals> totals(blocks);
  tbb::enumerable_thread_specific<Bins> bins;
  tbb::parallel_for(std::size_t{0}, blocks, [&](std::size_t b) {
    Bins& own = bins.local();
    std::array<double, per_item> distances;
    for (std::size_t i = b * block; i < std::min(items, (b + 1) * block); ++i) {
      const double weight = measure(i, distances);
      const auto units = static_cast<std::uint64_t>(std::llround(weight * 0x1p24));
      for (const double d : distances) {
        own.plain.add(d, 1);
        own.by_weight.add(d, units);
        totals[b].plain.add(d, 1);
        totals[b].by_weight.add(d, weight);
      }
    }
  });
  Totals all;
  for (const Totals& t : totals) {
    all.plain.add(t.plain);
    all.by_weight.add(t.by_weight);
  }
  Bins together;
  for (const Bins& own : bins) {
    together.plain.add(own.plain);
    together.by_weight.add(own.by_weight);
  }
  const std::uint64_t count = items * per_item;
  return {all.plain.with(together.plain, count), all.by_weight.with(together.by_weight, count)};
}

}  // namespace voxweld
