#include "stages/stitch/snap.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace voxweld {
namespace {

// The lattice points inside of the leaf's box, in absolute coordinates.
Box3 interior(const LatticeFrame& frame, CellKey leaf) {
  Box3 box;
  const double h = frame.lattice.step;
  for (int a = 0; a < 3; ++a) {
    const double first = static_cast<double>(frame.first[a] + leaf.at[a] * leaf.side());
    const double lo = (first - 1) * frame.spacing[a];
    const double hi = (first + static_cast<double>(leaf.side()) - 1) * frame.spacing[a];
    box.lo[a] = static_cast<std::int64_t>(std::floor(lo / h)) + 1;
    box.hi[a] = static_cast<std::int64_t>(std::ceil(hi / h));
  }
  return box;
}

// Those of them that do not lie beyond the volume's end, or so many steps at most. A node of several
// cells may reach far beyond it, and planes that meet there say nothing of the surface.
Box3 within_volume(const LatticeFrame& frame, const Box3& interior, int beyond) {
  Box3 box = interior;
  for (int a = 0; a < 3; ++a) box.hi[a] = std::min(box.hi[a], frame.end(a) + beyond + 1);
  return box;
}

// All lattice points, in absolute coordinates.
Box3 whole(const LatticeFrame& frame) {
  const Index3 lo{frame.origin(0), frame.origin(1), frame.origin(2)};
  return {lo, lo + splat(std::int64_t{1} << frame.lattice.bits)};
}

// Of those in the box.
Index3 nearest(const LatticeFrame& frame, CellKey leaf, const Box3& box,
               const std::array<float, 3>& offset) {
  Index3 q;
  for (int a = 0; a < 3; ++a) {
    const double side = static_cast<double>(leaf.side());
    const double first = static_cast<double>(frame.first[a]) - 1;
    const double centre =
        (first + (static_cast<double>(leaf.at[a]) + 0.5) * side) * frame.spacing[a];
    const double p =
        (centre + static_cast<double>(offset[static_cast<std::size_t>(a)])) / frame.lattice.step;
    q[a] = std::clamp(static_cast<std::int64_t>(std::floor(p + 0.5)), box.lo[a], box.hi[a] - 1);
  }
  return q;
}

LatticePoint relative(const LatticeFrame& frame, Index3 q) {
  LatticePoint point;
  for (int a = 0; a < 3; ++a)
    point[static_cast<std::size_t>(a)] = static_cast<std::int32_t>(q[a] - frame.origin(a));
  return point;
}

// Offsets by distance, then by coordinates.
std::vector<Index3> steps_by_distance(std::int64_t reach) {
  std::vector<Index3> steps;
  each_index({splat(-reach), splat(reach + 1)}, [&](Index3 step) { steps.push_back(step); });
  const auto distance = [](Index3 s) { return s.x * s.x + s.y * s.y + s.z * s.z; };
  std::stable_sort(steps.begin(), steps.end(),
                   [&](Index3 a, Index3 b) { return distance(a) < distance(b); });
  return steps;
}

std::int64_t modulo_3(std::int64_t value) {
  return (value % 3 + 3) % 3;
}

// The lattice points that vertices of one level may take where nodes overlap.
class LevelPoints {
 public:
  explicit LevelPoints(int level) : any_of_two_(level == 0) {
    int number = level;
    each_index(splat(3), [&](Index3 triple) {
      if (triple.x < 2 && triple.y < 2 && triple.z < 2) return;
      if (--number == 0) triple_ = triple;
    });
  }
  bool has(Index3 q) const {
    for (int a = 0; a < 3; ++a) {
      const std::int64_t rest = modulo_3(q[a]);
      if (any_of_two_ ? rest == 2 : rest != triple_[a]) return false;
    }
    return true;
  }

 private:
  bool any_of_two_;
  Index3 triple_;
};

}  // namespace

LatticePoint snap_vertex(const LatticeFrame& frame, CellKey leaf,
                         const std::array<float, 3>& offset) {
  return relative(frame,
                  nearest(frame, leaf, within_volume(frame, interior(frame, leaf), 0), offset));
}

LatticePoint point_of(const LatticeFrame& frame, CellKey leaf, const std::array<float, 3>& offset) {
  return relative(frame, nearest(frame, leaf, whole(frame), offset));
}

LatticePoint snap_sheets(const LatticeFrame& frame, CellKey leaf,
                         std::span<const LeafVertex> sheets) {
  // A cell's interior is at least three points a side, so four sheets always find a place.
  static const std::vector<Index3> steps = steps_by_distance(2);
  const Box3 box = interior(frame, leaf);
  std::array<Index3, 4> taken{};
  std::size_t count = 0;
  for (const LeafVertex& sheet : sheets) {
    const Index3 wanted = nearest(frame, leaf, box, sheet.offset);
    for (const Index3& step : steps) {
      const auto end = taken.begin() + static_cast<std::ptrdiff_t>(count);
      if (!box.contains(wanted + step) || std::find(taken.begin(), end, wanted + step) != end)
        continue;
      taken[count++] = wanted + step;
      break;
    }
  }
  return relative(frame, taken[count - 1]);
}

LatticePoint snap_in_group(const LatticeFrame& frame, CellKey node, bool shares,
                           std::span<const std::array<float, 3>> group) {
  const Box3 inside = interior(frame, node), sought = within_volume(frame, inside, 0);
  if (!shares && group.size() == 1) return relative(frame, nearest(frame, node, sought, group[0]));
  const Box3 box = within_volume(frame, inside, most_snap_steps);
  // Of level 0 a node has four vertices at most and eight points or more; of any other two points a
  // side or more of those that its level may take, so within so many steps there are enough.
  static const std::vector<Index3> steps = steps_by_distance(most_snap_steps);
  const LevelPoints points(node.level);
  std::vector<Index3> taken;
  for (const std::array<float, 3>& offset : group) {
    const Index3 wanted = nearest(frame, node, sought, offset);
    const auto free = std::find_if(steps.begin(), steps.end(), [&](const Index3& step) {
      const Index3 q = wanted + step;
      return box.contains(q) && (!shares || points.has(q)) &&
             std::find(taken.begin(), taken.end(), q) == taken.end();
    });
    taken.push_back(free == steps.end() ? wanted : wanted + *free);
  }
  return relative(frame, taken.back());
}

}  // namespace voxweld
