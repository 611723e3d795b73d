// What the filters share: their grids, rounding to a type, and buffers whose bytes can be counted.
#pragma once

#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <type_traits>

#include "stages/filter/kernel.h"

namespace voxweld::filter_detail {

class GridKernel : public FilterKernel {
 public:
  GridKernel(const SampleGrid& input, const SampleGrid& output) : input_(input), output_(output) {}
  const SampleGrid& input() const override { return input_; }
  const SampleGrid& output() const override { return output_; }

 private:
  SampleGrid input_, output_;
};

// With all samples at most `radius` away, as far as there are any.
inline Box3 widened(const Box3& box, Index3 radius, Index3 size) {
  return intersect({box.lo - radius, box.hi + radius}, {{}, size});
}

// To the nearest, ties to even, and kept within the type. NaN is 0 among integers.
template <class T>
T rounded(double v) {
  if constexpr (std::is_floating_point_v<T>) {
    return static_cast<T>(v);
  } else if constexpr (sizeof(T) <= 4) {
    constexpr double least = std::numeric_limits<T>::min(), most = std::numeric_limits<T>::max();
    v = v == v ? v : 0;
    v = v > least ? v : least;
    v = v < most ? v : most;
    // Of doubles this large the last bit is worth 1, so that adding rounds. Loops with it become
    // vectors, those with nearbyint do not.
    constexpr double integers = 0x1.8p52;
    v = (v + integers) - integers;
    using Wide = std::conditional_t<std::is_same_v<T, std::uint32_t>, std::int64_t, std::int32_t>;
    return static_cast<T>(static_cast<Wide>(v));
  } else {
    constexpr double least = static_cast<double>(std::numeric_limits<T>::min());
    constexpr double beyond = 2.0 * (std::uint64_t{1} << (std::numeric_limits<T>::digits - 1));
    if (v != v) return 0;
    if (v <= least) return std::numeric_limits<T>::min();
    if (v >= beyond) return std::numeric_limits<T>::max();
    return static_cast<T>(std::nearbyint(v));
  }
}

// Memory of which nothing is set.
template <class T>
std::unique_ptr<T[]> buffer_of(std::int64_t count) {
  return std::make_unique_for_overwrite<T[]>(static_cast<std::size_t>(count));
}
// What that takes. The allocator rounds up to pages.
template <class T>
std::uint64_t buffer_bytes(std::int64_t count) {
  return static_cast<std::uint64_t>(count) * sizeof(T) + 8192;
}

template <class T>
const T* samples_as(std::span<const std::byte> bytes) {
  return reinterpret_cast<const T*>(bytes.data());
}
template <class T>
T* samples_as(std::span<std::byte> bytes) {
  return reinterpret_cast<T*>(bytes.data());
}

}  // namespace voxweld::filter_detail
