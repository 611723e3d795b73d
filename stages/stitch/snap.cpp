#include "stages/stitch/snap.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace voxweld {
namespace {

struct Interior {
  std::array<std::int64_t, 3> lo, hi;  // inclusive, absolute lattice coordinates
};

Interior interior(const SnapFrame& frame, CellKey leaf) {
  Interior box;
  const double h = frame.lattice.step;
  for (int a = 0; a < 3; ++a) {
    const auto i = static_cast<std::size_t>(a);
    const double first = static_cast<double>(leaf.at[a] * leaf.side());
    const double lo = (first - 1) * frame.spacing[a];
    const double hi = (first + static_cast<double>(leaf.side()) - 1) * frame.spacing[a];
    box.lo[i] = static_cast<std::int64_t>(std::floor(lo / h)) + 1;
    box.hi[i] = static_cast<std::int64_t>(std::ceil(hi / h)) - 1;
  }
  return box;
}

std::array<std::int64_t, 3> nearest(const SnapFrame& frame, CellKey leaf, const Interior& box,
                                    const std::array<float, 3>& offset) {
  std::array<std::int64_t, 3> q;
  for (int a = 0; a < 3; ++a) {
    const auto i = static_cast<std::size_t>(a);
    const double side = static_cast<double>(leaf.side());
    const double centre = ((static_cast<double>(leaf.at[a]) + 0.5) * side - 1) * frame.spacing[a];
    const double p = (centre + static_cast<double>(offset[i])) / frame.lattice.step;
    q[i] = std::clamp(static_cast<std::int64_t>(std::floor(p + 0.5)), box.lo[i], box.hi[i]);
  }
  return q;
}

LatticePoint relative(const SnapFrame& frame, const std::array<std::int64_t, 3>& q) {
  LatticePoint point;
  for (std::size_t i = 0; i < 3; ++i)
    point[i] = static_cast<std::int32_t>(
        q[i] - static_cast<std::int64_t>(frame.lattice.origin[i] / frame.lattice.step));
  return point;
}

using Step = std::array<int, 3>;

// Offsets by distance, then by coordinates: a cell's interior is at least three points a side, so
// four sheets always find a place among these.
std::vector<Step> steps_by_distance() {
  std::vector<Step> steps;
  for (int z = -2; z <= 2; ++z)
    for (int y = -2; y <= 2; ++y)
      for (int x = -2; x <= 2; ++x) steps.push_back({x, y, z});
  const auto distance = [](const Step& s) { return s[0] * s[0] + s[1] * s[1] + s[2] * s[2]; };
  std::stable_sort(steps.begin(), steps.end(),
                   [&](const Step& a, const Step& b) { return distance(a) < distance(b); });
  return steps;
}

}  // namespace

LatticePoint snap_vertex(const SnapFrame& frame, CellKey leaf, const std::array<float, 3>& offset) {
  return relative(frame, nearest(frame, leaf, interior(frame, leaf), offset));
}

LatticePoint snap_sheets(const SnapFrame& frame, CellKey leaf, std::span<const LeafVertex> sheets) {
  static const std::vector<Step> steps = steps_by_distance();
  const Interior box = interior(frame, leaf);
  std::array<std::array<std::int64_t, 3>, 4> taken{};
  std::size_t count = 0;
  for (const LeafVertex& sheet : sheets) {
    const auto wanted = nearest(frame, leaf, box, sheet.offset);
    for (const Step& step : steps) {
      std::array<std::int64_t, 3> q;
      bool free = true;
      for (std::size_t i = 0; i < 3; ++i) {
        q[i] = wanted[i] + step[i];
        free = free && q[i] >= box.lo[i] && q[i] <= box.hi[i];
      }
      if (!free || std::find(taken.begin(), taken.begin() + static_cast<std::ptrdiff_t>(count),
                             q) != taken.begin() + static_cast<std::ptrdiff_t>(count))
        continue;
      taken[count++] = q;
      break;
    }
  }
  return relative(frame, taken[count - 1]);
}

}  // namespace voxweld
