// Filters as functions from samples to samples: which box of the input a box of the result needs,
// and what the result is of it. A sample of the result depends on its place in the volume alone,
// never on the box it is asked for in, so that any cutting up of the volume gives the same bits.
//
// Beyond the volume the nearest sample counts on (scipy.ndimage's mode "nearest"). Of integers the
// result is rounded to the nearest, ties to even, and kept within the type. Sums are of doubles, in
// one fixed order; of 64-bit integers that is exact to 2^53 only.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include "storage/types/box.h"
#include "storage/types/sample_type.h"

namespace voxweld {

struct SampleGrid {
  Index3 size;  // samples a side
  SampleType type = SampleType::u8;
};

class FilterKernel {
 public:
  virtual ~FilterKernel() = default;

  virtual const SampleGrid& input() const = 0;
  virtual const SampleGrid& output() const = 0;
  // The samples of the input that those of `box` are made from. Not empty, inside the input.
  // Precondition: box not empty, inside the output.
  virtual Box3 needs(const Box3& box) const = 0;
  // Fills `out` with the samples of `box`. samples: those of needs(box). Both x fastest, tightly
  // packed. Thread-safe.
  virtual void apply(const Box3& box, std::span<const std::byte> samples,
                     std::span<std::byte> out) const = 0;
  // What apply takes besides both, at most, in bytes.
  virtual std::uint64_t scratch_bytes(const Box3& box) const = 0;
  // Whether a sample costs one sample of the input, so that what is filtered need not be kept.
  virtual bool one_to_one() const { return false; }
};

// value -> clip -> straight line from `clip` to `scale` -> type. In stored values.
struct WindowParameters {
  double lo = 0, hi = 0;  // clipped to; lo < hi, hi - lo a finite number
  // Where lo and hi go; empty: nowhere else. Of a range that falls the result is turned over.
  std::optional<std::array<double, 2>> scale{};
  SampleType type = SampleType::u8;  // of the result
};
std::unique_ptr<FilterKernel> window_kernel(const SampleGrid& input,
                                            const WindowParameters& parameters);
// sigma: in samples along each axis, 0: not along it. The weights end at the nearest integer to
// 4 sigma and add up to 1, as those of scipy.ndimage.gaussian_filter. type: of the result.
std::unique_ptr<FilterKernel> gaussian_kernel(const SampleGrid& input, Vec3 sigma, SampleType type);
// Of a box of 2 radius + 1 samples a side. Of floats, NaN where one of them is.
std::unique_ptr<FilterKernel> mean_kernel(const SampleGrid& input, Index3 radius, SampleType type);
// The same; NaNs count as the largest.
std::unique_ptr<FilterKernel> median_kernel(const SampleGrid& input, Index3 radius);

enum class DownsampleMethod : std::uint8_t { mean, max, mode };
// One sample of factor.x * factor.y * factor.z; what is left over at the upper ends is dropped.
// mode: the value that most of them have, of several the least. NaN is one value, the largest.
// type: of the result; of max and mode that of the input. Precondition: 1 <= factor <= size.
std::unique_ptr<FilterKernel> downsample_kernel(const SampleGrid& input, Index3 factor,
                                                DownsampleMethod method, SampleType type);
// Turns around the axes that are true.
std::unique_ptr<FilterKernel> flip_kernel(const SampleGrid& input, std::array<bool, 3> axes);
// Axis a of the result is axis order[a] of the input. Precondition: order has 0, 1 and 2.
std::unique_ptr<FilterKernel> permute_kernel(const SampleGrid& input, std::array<int, 3> order);

}  // namespace voxweld
