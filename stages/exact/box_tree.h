// Boxes on the output lattice, to be asked which of them meet another.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "storage/types/lattice_box.h"

namespace voxweld {

// A tree of eight branches over the boxes in Morton order of their middles, without pointers.
class BoxTree {
 public:
  explicit BoxTree(const std::vector<LatticeBox>& boxes);

  // f(number) for each box that meets `box`, in an order that depends on the boxes alone.
  template <class F>
  void each_meeting(const LatticeBox& box, F&& f) const {
    any_meeting(box, [&](std::uint32_t number) {
      f(number);
      return false;
    });
  }
  // Whether f(number) is true for one that meets `box`; nothing is asked after that one.
  template <class F>
  bool any_meeting(const LatticeBox& box, F&& f) const {
    return !levels_.empty() && visit(levels_.size() - 1, 0, box, f);
  }

 private:
  static constexpr std::size_t branches = 8;

  // Of the node `at` of that level its branches.
  template <class F>
  bool visit(std::size_t level, std::size_t at, const LatticeBox& box, F& f) const {
    if (!levels_[level][at].meets(box)) return false;
    if (level == 0) return f(order_[at]);
    const std::size_t end = std::min((at + 1) * branches, levels_[level - 1].size());
    for (std::size_t below = at * branches; below < end; ++below)
      if (visit(level - 1, below, box, f)) return true;
    return false;
  }

  std::vector<std::uint32_t> order_;  // numbers of boxes, along the curve
  std::vector<std::vector<LatticeBox>>
      levels_;  // first the boxes themselves; last one that holds all
};

}  // namespace voxweld
