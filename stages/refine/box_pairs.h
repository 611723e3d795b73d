// All pairs of boxes that meet.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <vector>

#include "stages/refine/packed_box.h"

namespace voxweld {

// A tree of eight branches over boxes in the order in which they come. Quick where those that follow
// each other are mostly near each other, as triangles are that come in the order of some lattice.
class BoxPairs {
 public:
  explicit BoxPairs(const std::vector<LatticeBox>& boxes);

  // f(a, b) once for each two that may meet, a < b, in an order that depends on the boxes alone.
  template <class F>
  void each(F&& f) const {
    for (std::size_t g = 0; g < count(0); ++g) visit(levels_.size() - 1, 0, g, group_of(0, g), f);
  }

 private:
  static constexpr std::size_t branches = 8;
  // Low corners of eight boxes, and high ones negated.
  struct Eight {
    EightShorts ends[6];
  };
  // What those must be at most to meet a box.
  struct Most {
    EightShorts ends[6];

    std::uint32_t meeting(const Eight& eight) const {
      EightShorts meets = eight.ends[0] <= ends[0];
      for (std::size_t k = 1; k < 6; ++k) meets &= eight.ends[k] <= ends[k];
      return bits_of(meets);
    }
  };
  static Most most_of(const Eight& eight, std::size_t lane) {
    Most most;
    for (std::size_t a = 0; a < 3; ++a) {
      most.ends[a] = EightShorts{} + static_cast<std::int16_t>(-eight.ends[a + 3][lane]);
      most.ends[a + 3] = EightShorts{} + static_cast<std::int16_t>(-eight.ends[a][lane]);
    }
    return most;
  }
  std::size_t count(std::size_t level) const { return levels_[level].size(); }
  // To meet the box around all of `eight` number n of that level.
  Most group_of(std::size_t level, std::size_t n) const {
    return most_of(levels_[level + 1][n / branches], n % branches);
  }

  // Under number n of the level the groups of boxes from g on that may meet the box around group g.
  template <class F>
  void visit(std::size_t level, std::size_t n, std::size_t g, const Most& most, F& f) const {
    if (level == 0) return meet(g, n, most, f);
    std::uint32_t bits = most.meeting(levels_[level][n]);
    for (; bits != 0; bits &= bits - 1) {
      const std::size_t below = n * branches + static_cast<std::size_t>(std::countr_zero(bits));
      if ((below + 1) << (3 * (level - 1)) > g) visit(level - 1, below, g, most, f);
    }
  }

  // Of two groups. most: to meet the box around group g.
  template <class F>
  void meet(std::size_t g, std::size_t h, const Most& most, F& f) const {
    const Eight &ours = levels_[0][g], &theirs = levels_[0][h];
    const std::uint32_t near = most.meeting(theirs);
    if (near == 0) return;
    for (std::uint32_t some = group_of(0, h).meeting(ours); some != 0; some &= some - 1) {
      const auto i = static_cast<std::size_t>(std::countr_zero(some));
      std::uint32_t bits = most_of(ours, i).meeting(theirs) & near;
      if (g == h) bits &= ~1u << i;
      for (; bits != 0; bits &= bits - 1)
        f(static_cast<std::uint32_t>(g * branches + i),
          static_cast<std::uint32_t>(h * branches +
                                     static_cast<std::size_t>(std::countr_zero(bits))));
    }
  }

  std::vector<std::vector<Eight>> levels_;  // first the boxes; last one of these alone
};

// Bytes for so many boxes.
inline std::uint64_t box_pairs_bytes(std::uint64_t boxes) {
  return boxes * 12 * 8 / 7 + 1024;
}

}  // namespace voxweld
