// Phantoms that exist at sample positions only: labels and noise.
#pragma once

#include <cstdint>
#include <vector>

#include "pipeline/phantom/fields.h"

namespace voxweld {

// A fixed counter-based hash: 64 well-mixed bits of a key and a counter (the finaliser of
// SplitMix64; Steele, Lea and Flood, "Fast Splittable Pseudorandom Number Generators", 2014).
constexpr std::uint64_t mix_bits(std::uint64_t key, std::uint64_t counter) {
  std::uint64_t z = key + (counter + 1) * 0x9e3779b97f4a7c15ULL;
  z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ z >> 27) * 0x94d049bb133111ebULL;
  return z ^ z >> 31;
}
// The key of a row of samples; mix_bits(row_key(...), x) is the hash of one sample.
constexpr std::uint64_t row_key(std::uint64_t seed, std::int64_t y, std::int64_t z) {
  return mix_bits(mix_bits(mix_bits(0, seed), static_cast<std::uint64_t>(z)),
                  static_cast<std::uint64_t>(y));
}
// Uniform in (0, 1), never 0, 1/2 or 1.
constexpr double uniform(std::uint64_t bits) {
  return (static_cast<double>(bits >> 40) + 0.5) / 16777216.0;
}

// d = 16 u - 8 with u uniform of each sample: half of all samples inside, in every pattern, with
// the same signs in every sample type.
class NoiseField : public PhantomField {
 public:
  explicit NoiseField(std::uint64_t seed) : seed_(seed) {}
  void fill(const Box3& box, double limit, double* out) const override;
  Index3 block() const override { return {256, 4, 4}; }

 private:
  std::uint64_t seed_;
};

// The ball of radius 0.45 N is divided among 6^3 points, one in each cell of side N / 6, placed at
// a random 0.1 .. 0.9 of the cell on each axis; a sample's label is 1 + the index (x fastest) of
// the point nearest to it, the lower index on a tie, and 0 outside the ball.
class LabelsField : public PhantomField {
 public:
  LabelsField(std::int64_t size, std::uint64_t seed);
  static constexpr std::uint64_t labels = 216;
  void fill(const Box3& box, double limit, double* out) const override;
  Index3 block() const override { return {16, 8, 8}; }
  std::uint64_t scratch_bytes() const override { return 1 << 14; }

 private:
  // Points that can be the nearest to some sample of box, in rising order.
  std::vector<std::size_t> candidates(const Box3& box) const;

  double centre_, radius_;
  std::vector<Vec3> points_;
};

}  // namespace voxweld
