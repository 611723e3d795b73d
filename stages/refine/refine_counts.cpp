#include <algorithm>
#include <cmath>

#include "stages/refine/refine_range.h"

namespace voxweld {
namespace {

// The upper border of a bin.
double bin_end(std::size_t bin) {
  return std::exp2(static_cast<double>(bin) / 4 - 8);
}

}  // namespace

void RefineCounts::add(const RefineCounts& other) {
  cubes += other.cubes;
  collapses += other.collapses;
  moves += other.moves;
  flips += other.flips;
  pairs_before += other.pairs_before;
  pairs_left += other.pairs_left;
  worst = std::max(worst, other.worst);
  for (std::size_t b = 0; b < distances.size(); ++b) distances[b] += other.distances[b];
}

RefineCounts RefineCounts::patched_by(const RefineCounts& mended) const {
  RefineCounts sum = *this;
  sum.add(mended);
  sum.pairs_before = pairs_before;
  sum.pairs_left = pairs_left - mended.pairs_before + mended.pairs_left;
  return sum;
}

void RefineCounts::add_distance(double distance) {
  worst = std::max(worst, distance);
  ++bin(distance);
}

void RefineCounts::remove_distance(double distance) {
  --bin(distance);
}

std::uint64_t& RefineCounts::bin(double distance) {
  const double bin = distance > 0 ? std::ceil(4 * (std::log2(distance) + 8)) : 0;
  const double last = static_cast<double>(distances.size() - 1);
  return distances[static_cast<std::size_t>(std::clamp(bin, 0.0, last))];
}

double RefineCounts::quantile(double part) const {
  std::uint64_t all = 0, below = 0;
  for (const std::uint64_t n : distances) all += n;
  for (std::size_t b = 0; b + 1 < distances.size(); ++b) {
    below += distances[b];
    if (static_cast<double>(below) >= part * static_cast<double>(all))
      return std::min(worst, bin_end(b));
  }
  return worst;
}

}  // namespace voxweld
