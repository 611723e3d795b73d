// Thresholded band-limited noise.
#pragma once

#include <cstdint>
#include <vector>

#include "pipeline/phantom/fields.h"

namespace voxweld {

// White noise, for each sample the sum of four uniform bytes of its hash, is box-blurred three
// times along each axis with width 11, wrapping, and scaled to mean 0 and variance 1: w. Then
//   d = -(w - 0.4 + 0.015 n) * 8
// with n another such sum of the same hash, unblurred, mean 0 and variance 1; in the outermost
// layer of samples w - 0.4 is replaced by -4.
//
// The blur is exact in integers: a triple box is the third difference with step 11 followed by
// three running sums, which wrap around harmlessly (Hogenauer, "An Economical Class of Digital
// Filters for Decimation and Interpolation", 1981). So any box gives the same bits, computed from
// its own halo of 15 samples, and along z only the slices the blur reaches back to are kept.
class PorousField : public PhantomField {
 public:
  PorousField(std::int64_t size, std::uint64_t seed);
  void fill(const Box3& box, double limit, double* out) const override;
  Index3 block() const override { return {256, 128, 64}; }
  std::uint64_t scratch_bytes() const override;

  // The variance of the blurred sum, before scaling: that of the white noise times, for each axis,
  // the sum of squares of the blur's weights (folded where the blur is longer than the volume).
  static double blurred_variance(std::int64_t size);

 private:
  struct Slice;
  void blur_slice(const Box3& box, std::int64_t z, Slice& scratch, std::uint32_t* out) const;
  void emit_slice(const Box3& box, std::int64_t z, const std::uint64_t* blurred, double* out) const;

  std::int64_t size_;
  std::uint64_t seed_;
  double mean_, scale_;  // of the blurred sum
};

}  // namespace voxweld
