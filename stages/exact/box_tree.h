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
    const auto ask = [&](std::size_t at) { return f(order_[at]); };
    return !levels_.empty() && visit(levels_.size() - 1, 0, box, ask);
  }
  // The same, but what lies near a place along the curve is asked first: quicker where f is true of many
  // boxes. place: any; where the result is true that of the box in question.
  template <class F>
  bool any_meeting_near(const LatticeBox& box, std::uint32_t& place, F&& f) const {
    if (levels_.empty()) return false;
    const auto ask = [&](std::size_t at) {
      if (!f(order_[at])) return false;
      place = static_cast<std::uint32_t>(at);
      return true;
    };
    std::size_t from = std::min<std::size_t>(place, order_.size() - 1);
    if (visit(0, from, box, ask)) return true;
    // What lies beside the way up.
    for (std::size_t level = 1; level < levels_.size(); ++level) {
      const std::size_t at = from / branches;
      if (levels_[level][at].meets(box) && visit_below(level, at, box, ask, from)) return true;
      from = at;
    }
    return false;
  }

 private:
  static constexpr std::size_t branches = 8;
  static constexpr std::size_t none = ~std::size_t{0};

  // Of the node `at` of that level its branches. f: of places.
  template <class F>
  bool visit(std::size_t level, std::size_t at, const LatticeBox& box, F& f) const {
    if (!levels_[level][at].meets(box)) return false;
    return level == 0 ? f(at) : visit_below(level, at, box, f, none);
  }
  // Not `but`.
  template <class F>
  bool visit_below(std::size_t level, std::size_t at, const LatticeBox& box, F& f,
                   std::size_t but) const {
    const std::size_t end = std::min((at + 1) * branches, levels_[level - 1].size());
    for (std::size_t below = at * branches; below < end; ++below)
      if (below != but && visit(level - 1, below, box, f)) return true;
    return false;
  }

  std::vector<std::uint32_t> order_;  // numbers of boxes, along the curve
  std::vector<std::vector<LatticeBox>>
      levels_;  // first the boxes themselves; last one that holds all
};

}  // namespace voxweld
