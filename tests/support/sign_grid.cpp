#include "tests/support/sign_grid.h"

namespace voxweld::testing {

SignGrid::SignGrid(Index3 size, const std::function<bool(Index3)>& inside) : size_(size) {
  each_index(size, [&](Index3 at) { inside_.push_back(inside(at)); });
}

bool SignGrid::inside(Index3 p) const {
  const Index3 sample = p - splat(1);
  if (!Box3{{0, 0, 0}, size_}.contains(sample)) return false;
  return inside_[static_cast<std::size_t>((sample.z * size_.y + sample.y) * size_.x + sample.x)];
}

CrossingCounts count_crossings(const SignGrid& grid) {
  CrossingCounts counts;
  const Index3 end = grid.cells().hi;
  each_index(end, [&](Index3 at) {
    const bool here = grid.inside(at);
    counts.x += here != grid.inside(at + Index3{1, 0, 0});
    counts.y += here != grid.inside(at + Index3{0, 1, 0});
    counts.z += here != grid.inside(at + Index3{0, 0, 1});
  });
  return counts;
}

}  // namespace voxweld::testing
