// Dense volumes as inside/outside signs on the lattice, with the virtual ring, and what can be
// counted on them plainly.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "storage/types/box.h"

namespace voxweld::testing {

// Signs at lattice points 0 <= u <= size + 1 on each axis, u = sample index + 1: the outermost
// layer is virtual and outside. Everything further out is outside too.
class SignGrid {
 public:
  // inside(sample index) for each of the size.x * size.y * size.z samples.
  SignGrid(Index3 size, const std::function<bool(Index3)>& inside);

  Index3 size() const { return size_; }     // samples a side
  bool inside(Index3 lattice_point) const;  // any point; outside beyond the ring
  // Cells with a sample among their corners: 0 <= u <= size.
  Box3 cells() const { return {{0, 0, 0}, size_ + splat(1)}; }

 private:
  Index3 size_;
  std::vector<bool> inside_;  // of samples, x fastest
};

// The rule of the tool: equal to the isovalue is inside, NaN is outside. Exact for every sample
// type: long double holds all 64-bit integers and doubles.
template <class T>
bool inside_below(T value, double isovalue) {
  return static_cast<long double>(value) <= static_cast<long double>(isovalue);
}
template <class T>
bool inside_above(T value, double isovalue) {
  return static_cast<long double>(value) >= static_cast<long double>(isovalue);
}

// Signs of a dense volume, x fastest; inside(sample value).
template <class T, class F>
SignGrid signs_of(Index3 size, std::span<const T> samples, F&& inside) {
  return SignGrid(size, [&](Index3 p) {
    return inside(samples[static_cast<std::size_t>((p.z * size.y + p.y) * size.x + p.x)]);
  });
}

// Lattice edges whose ends differ, along each axis, edges into the virtual ring included.
struct CrossingCounts {
  std::int64_t x = 0, y = 0, z = 0;
  std::int64_t total() const { return x + y + z; }
  friend bool operator==(const CrossingCounts&, const CrossingCounts&) = default;
};
CrossingCounts count_crossings(const SignGrid& grid);

}  // namespace voxweld::testing
