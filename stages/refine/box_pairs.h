// All pairs of boxes that meet.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
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
    std::vector<std::size_t> near;
    for (std::size_t first = 0; first < levels_[0].size(); first += branches) {
      near.clear();
      add_near(first / branches, near);
      const std::size_t end = std::min(first + branches, levels_[0].size());
      for (std::size_t g = first; g < end; ++g) meet(Group(*this, g), near, f);
    }
  }

 private:
  static constexpr std::size_t branches = 8;
  // Low corners of eight boxes, and high ones negated. Where there is no box: of one that meets none.
  struct alignas(16) Eight {
    std::array<std::int16_t, branches> ends[6];

    Eight() {
      for (auto& end : ends) end.fill(INT16_MAX);
    }
    EightShorts end(std::size_t k) const {
      EightShorts values;
      std::memcpy(&values, ends[k].data(), sizeof values);
      return values;
    }
  };
  // What those must be at most to meet a box.
  struct Most {
    EightShorts ends[6];

    std::uint32_t meeting(const Eight& eight) const {
      EightShorts apart = eight.end(0) > ends[0];  // quicker than to ask what is not larger
      for (std::size_t k = 1; k < 6; ++k) apart |= eight.end(k) > ends[k];
      return bits_of(apart) ^ 0xffu;
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
  // To meet the box around all of `eight` number n of that level.
  Most around(std::size_t level, std::size_t n) const {
    return most_of(levels_[level + 1][n / branches], n % branches);
  }
  // Eight boxes to hold others against, all together and each.
  struct Group {
    Group(const BoxPairs& boxes, std::size_t n) : number(n), around(boxes.around(0, n)) {
      for (std::size_t i = 0; i < branches; ++i) each[i] = most_of(boxes.levels_[0][n], i);
    }
    std::size_t number;
    Most around, each[branches];
  };

  // Blocks are numbers of level 1, of eight groups each. Those from `block` on that may meet it.
  void add_near(std::size_t block, std::vector<std::size_t>& near) const {
    if (levels_.size() > 2)
      add_near(levels_.size() - 1, 0, block, around(1, block), near);
    else
      near.push_back(0);  // there is one
  }
  // Of those under number n of the level, which is above 1. most: to meet the block.
  void add_near(std::size_t level, std::size_t n, std::size_t block, const Most& most,
                std::vector<std::size_t>& near) const;

  template <class F>
  void meet(const Group& group, const std::vector<std::size_t>& blocks, F& f) const {
    for (const std::size_t block : blocks) {
      std::uint32_t bits = group.around.meeting(levels_[1][block]);
      for (; bits != 0; bits &= bits - 1) {
        const std::size_t other =
            block * branches + static_cast<std::size_t>(std::countr_zero(bits));
        if (other >= group.number) meet(group, other, f);
      }
    }
  }

  // Of two groups.
  template <class F>
  void meet(const Group& group, std::size_t other, F& f) const {
    const Eight& theirs = levels_[0][other];
    if (group.around.meeting(theirs) == 0) return;
    // All 64 pairs at once: processors guess the ends of eight loops badly.
    std::uint64_t bits = 0;
    for (std::size_t i = 0; i < branches; ++i)
      bits |= std::uint64_t{group.each[i].meeting(theirs)} << (branches * i);
    if (group.number == other) bits &= 0x0080c0e0f0f8fcfeu;  // each pair once
    for (; bits != 0; bits &= bits - 1) {
      const auto pair = static_cast<std::size_t>(std::countr_zero(bits));
      f(static_cast<std::uint32_t>(group.number * branches + pair / branches),
        static_cast<std::uint32_t>(other * branches + pair % branches));
    }
  }

  std::vector<std::vector<Eight>> levels_;  // first the boxes; last one of these alone
};

// Bytes for so many boxes.
inline std::uint64_t box_pairs_bytes(std::uint64_t boxes) {
  return boxes * 12 * 8 / 7 + 1024;
}

}  // namespace voxweld
