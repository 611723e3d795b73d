// How many triangles of a mesh are left, by how far its edges are collapsed: what survey and recount
// leave, and the tolerances of refine and seams are chosen by.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace voxweld {

// Of some cubes, in one pass.
struct CollapseSurvey {
  // As they come: triangles that may be changed, those that may not, and of these those that the other
  // pass may not change either; vertices at the border of what may be changed, which stay.
  std::uint64_t inside = 0, fixed = 0, held = 0, border = 0;
  std::vector<std::uint64_t> left;  // of the first, for each tolerance; these ascend

  std::uint64_t all() const { return inside + fixed; }
  // Precondition: both are of the same tolerances, or this is of none yet.
  void add(const CollapseSurvey& other) {
    inside += other.inside;
    fixed += other.fixed;
    held += other.held;
    border += other.border;
    if (left.size() < other.left.size()) left.resize(other.left.size());
    for (std::size_t i = 0; i < other.left.size(); ++i) left[i] += other.left[i];
  }
  friend bool operator==(const CollapseSurvey&, const CollapseSurvey&) = default;
};

}  // namespace voxweld
