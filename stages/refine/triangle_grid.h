// The triangles near a place, while they change.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <vector>

#include "stages/refine/packed_box.h"
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
    const BoxQuery query(pack_, box);
    none_of_bins(box, [&](const PackedBox& one) {
      if (query.meets(one)) f(one.number());
      return false;
    });
  }
  BoxQueries queries() const { return BoxQueries(pack_); }
  PackedBox packed(std::uint32_t triangle, const LatticeBox& box) const {
    return {pack_, box, triangle};
  }
  // Whether f(triangle, boxes) is false for each that may meet some of these boxes, one bit each. It
  // ends where f is true.
  template <class F>
  bool none_near(const BoxQueries& boxes, F&& f) const {
    const BoxQuery query(pack_, boxes.around());
    return none_of_bins(boxes.around(), [&](const PackedBox& one) {
      if (!query.meets(one)) return false;
      const std::uint64_t met = boxes.meeting(one);
      return met != 0 && f(one.number(), met);
    });
  }

 private:
  using Place = std::array<std::int32_t, 3>;
  struct Level {
    std::int32_t side = 1;       // bins a side
    std::array<int, 3> shift{};  // log2 of their sizes
    std::size_t first = 0;       // of its bins
    std::size_t first_row = 0;   // of its rows of bins
    std::size_t count = 0;       // triangles in it
  };
  static std::size_t row(const Level& level, const Place& at) {
    return static_cast<std::size_t>(at[2]) * static_cast<std::size_t>(level.side) +
           static_cast<std::size_t>(at[1]);
  }
  static std::size_t number(const Level& level, const Place& at) {
    return level.first + row(level, at) * static_cast<std::size_t>(level.side) +
           static_cast<std::size_t>(at[0]);
  }
  template <class F>
  bool none_of_bins(const LatticeBox& box, F&& f) const {
    for (const Level& level : levels_) {
      if (level.count == 0) continue;
      Place lo = place(level, box.lo);
      const Place hi = place(level, box.hi);
      for (std::int32_t& at : lo) at = std::max(at - 1, 0);
      const std::uint32_t span = (~0u << lo[0]) & (~0u >> (most_side - 1 - hi[0]));
      for (std::int32_t z = lo[2]; z <= hi[2]; ++z)
        for (std::int32_t y = lo[1]; y <= hi[1]; ++y) {
          const std::size_t row_here = row(level, {0, y, z});
          const std::vector<PackedBox>* bins = &bins_[number(level, {0, y, z})];
          for (std::uint32_t some = rows_[level.first_row + row_here] & span; some != 0;
               some &= some - 1)
            for (const PackedBox& one : bins[std::countr_zero(some)])
              if (f(one)) return false;
        }
    }
    return true;
  }
  Place place(const Level& level, const LatticePoint& p) const {
    Place at;
    for (std::size_t a = 0; a < 3; ++a)
      at[a] = std::clamp((p[a] - lo_[a]) >> level.shift[a], 0, level.side - 1);
    return at;
  }
  std::size_t level_of(const LatticeBox& box) const;
  void mark(const Level& level, std::uint32_t bin);

  static constexpr std::uint32_t none = 0xffffffffu;
  LatticePoint lo_;
  std::vector<Level> levels_;  // the smallest bins first; last one bin for all
  BoxPacker pack_;
  std::vector<std::vector<PackedBox>> bins_;
  static constexpr std::int32_t most_side = 32;
  std::vector<std::uint32_t> rows_;  // of each row of bins a bit for each that holds something
  struct Slot {
    std::uint32_t bin = none, place = 0;
  };
  std::vector<Slot> slots_;  // of triangles
};

}  // namespace voxweld
