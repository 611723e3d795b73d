// Boxes of points of the output lattice.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>

#include "storage/types/output_lattice.h"

namespace voxweld {

struct LatticeBox {
  LatticePoint lo{}, hi{};  // both included

  static LatticeBox around(std::span<const LatticePoint> points) {  // at least one
    LatticeBox box{points.front(), points.front()};
    for (const LatticePoint& p : points.subspan(1)) box.extend({p, p});
    return box;
  }
  // Here and in meets() no branches: of boxes that are near each other nobody can guess the answer.
  void extend(const LatticeBox& other) {
    for (std::size_t a = 0; a < 3; ++a) {
      lo[a] = std::min(lo[a], other.lo[a]);
      hi[a] = std::max(hi[a], other.hi[a]);
    }
  }
  bool meets(const LatticeBox& other) const {
    bool apart = false;
    for (std::size_t a = 0; a < 3; ++a)
      apart |= static_cast<bool>(static_cast<int>(hi[a] < other.lo[a]) |
                                 static_cast<int>(other.hi[a] < lo[a]));
    return !apart;
  }
  // Precondition: they meet.
  LatticeBox common(const LatticeBox& other) const {
    LatticeBox box = *this;
    for (std::size_t a = 0; a < 3; ++a) {
      if (other.lo[a] > lo[a]) box.lo[a] = other.lo[a];
      if (other.hi[a] < hi[a]) box.hi[a] = other.hi[a];
    }
    return box;
  }
  bool contains(const LatticePoint& p) const { return meets({p, p}); }
  friend bool operator==(const LatticeBox&, const LatticeBox&) = default;
};

}  // namespace voxweld
