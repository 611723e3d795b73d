// The triangles near a place, while they change.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "storage/types/lattice_box.h"

namespace voxweld {

// Bins of several sizes over a box; what lies beyond counts to those at its border. A triangle is in
// one bin: of the smallest size that is no smaller than its box, where the lower corner of that lies.
// So a query looks one bin further down on each axis.
class TriangleGrid {
 public:
  // triangles: how many there will be; more than some make more bins.
  TriangleGrid(const LatticeBox& box, std::size_t triangles);

  // The next triangle, or one that has changed.
  void put(std::uint32_t triangle, const LatticeBox& box);
  void remove(std::uint32_t triangle);

  // f(triangle) once for each that may meet the box, in an order that depends on the calls alone.
  template <class F>
  void each_near(const LatticeBox& box, F&& f) const {
    for (const Level& level : levels_) {
      if (level.count == 0) continue;
      LatticePoint below = box.lo;
      for (std::size_t a = 0; a < 3; ++a) below[a] -= level.size[a];
      const Place lo = place(level, below), hi = place(level, box.hi);
      for (std::int32_t z = lo[2]; z <= hi[2]; ++z)
        for (std::int32_t y = lo[1]; y <= hi[1]; ++y)
          for (std::int32_t x = lo[0]; x <= hi[0]; ++x)
            for (const std::uint32_t t : bins_[number(level, {x, y, z})]) f(t);
    }
  }

 private:
  using Place = std::array<std::int32_t, 3>;
  struct Level {
    std::int32_t side = 1;  // bins a side
    LatticePoint size{};    // of a bin
    std::size_t first = 0;  // of its bins
    std::size_t count = 0;  // triangles in it
  };
  static std::size_t number(const Level& level, const Place& at) {
    return level.first +
           static_cast<std::size_t>((at[2] * level.side + at[1]) * level.side + at[0]);
  }
  Place place(const Level& level, const LatticePoint& p) const {
    Place at;
    for (std::size_t a = 0; a < 3; ++a)
      at[a] = std::clamp((p[a] - lo_[a]) / level.size[a], 0, level.side - 1);
    return at;
  }
  std::size_t level_of(const LatticeBox& box) const;

  static constexpr std::uint32_t none = 0xffffffffu;
  LatticePoint lo_;
  std::vector<Level> levels_;  // the smallest bins first; last one bin for all
  std::vector<std::vector<std::uint32_t>> bins_;
  std::vector<std::uint32_t> bin_of_;
};

}  // namespace voxweld
