#include "tests/support/sign_grid.h"

namespace voxweld::testing {

SignGrid::SignGrid(Index3 size, const std::function<bool(Index3)>& inside) : size_(size) {
  for (std::int64_t z = 0; z < size.z; ++z)
    for (std::int64_t y = 0; y < size.y; ++y)
      for (std::int64_t x = 0; x < size.x; ++x) inside_.push_back(inside({x, y, z}));
}

bool SignGrid::inside(Index3 p) const {
  const Index3 sample = p - splat(1);
  if (!Box3{{0, 0, 0}, size_}.contains(sample)) return false;
  return inside_[static_cast<std::size_t>((sample.z * size_.y + sample.y) * size_.x + sample.x)];
}

CrossingCounts count_crossings(const SignGrid& grid) {
  CrossingCounts counts;
  const Index3 end = grid.cells().hi;
  for (std::int64_t z = 0; z < end.z; ++z)
    for (std::int64_t y = 0; y < end.y; ++y)
      for (std::int64_t x = 0; x < end.x; ++x) {
        const bool here = grid.inside({x, y, z});
        counts.x += here != grid.inside({x + 1, y, z});
        counts.y += here != grid.inside({x, y + 1, z});
        counts.z += here != grid.inside({x, y, z + 1});
      }
  return counts;
}

}  // namespace voxweld::testing
