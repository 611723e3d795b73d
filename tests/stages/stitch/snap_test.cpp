// Where vertices come to lie on the output lattice.
#include "stages/stitch/snap.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <vector>

#include "stages/stitch/lattice_plan.h"

namespace voxweld {
namespace {

using Offset = std::array<float, 3>;

// A volume whose end cuts nodes of any level: cell 21 is its last one, from sample 20 on.
LatticeFrame cut_frame(double precision, Vec3 spacing, Index3 first) {
  const Index3 size = splat(21);
  return {plan_lattice({size, spacing, precision, first}), spacing, first, size};
}

// In the output's coordinates.
double place(const LatticeFrame& frame, const LatticePoint& point, int axis) {
  const auto a = static_cast<std::size_t>(axis);
  return frame.lattice.origin[a] + point[a] * frame.lattice.step;
}
double end_of(const LatticeFrame& frame, int axis) {
  return static_cast<double>(frame.first[axis] + frame.size[axis]) * frame.spacing[axis];
}

TEST(Snap, NoVertexLiesBeyondTheVolumesEnd) {
  for (const Vec3 spacing : {Vec3{1, 1, 1}, Vec3{0.7, 1, 2.1}, Vec3{0.9985, 0.3, 12.5}})
    for (const Index3 first : {Index3{}, Index3{7, 0, 300}}) {
      const LatticeFrame frame = cut_frame(0.01, spacing, first);
      // Cells 16 to 23, of which 22 and 23 lie beyond the end.
      const CellKey node{3, splat(2)};
      const Offset far{static_cast<float>(3.9 * spacing.x), static_cast<float>(3.9 * spacing.y),
                       static_cast<float>(3.9 * spacing.z)};
      const Offset group[] = {far};
      for (const LatticePoint& point :
           {snap_vertex(frame, node, far), snap_in_group(frame, node, false, group)})
        for (int a = 0; a < 3; ++a) {
          EXPECT_GE(place(frame, point, a), end_of(frame, a));
          EXPECT_LT(place(frame, point, a), end_of(frame, a) + frame.lattice.step);
        }
      // What lies within it is where it was.
      const Offset near{-0.5F, 0.25F, 0};
      LatticeFrame endless = frame;
      endless.size = LatticeFrame{}.size;
      EXPECT_EQ(snap_vertex(frame, node, near), snap_vertex(endless, node, near));
      EXPECT_NE(snap_vertex(frame, node, far), snap_vertex(endless, node, far));
    }
}

// Even where a cell has three points a side inside and a node but one cell.
TEST(Snap, VerticesOfANodeThatIsCutAreDistinct) {
  for (const double precision : {0.25, 0.01})
    for (const bool shares : {false, true}) {
      const LatticeFrame frame = cut_frame(precision, {1, 1, 1}, {});
      for (const CellKey node :
           {CellKey{1, splat(10)}, CellKey{2, splat(5)}, CellKey{0, splat(21)}}) {
        const std::size_t most = node.level == 0 ? 4 : 8;
        std::set<LatticePoint> points;
        std::vector<Offset> group;
        while (group.size() < most) {
          group.push_back({3, 3, 3});
          const LatticePoint point = snap_in_group(frame, node, shares, group);
          EXPECT_TRUE(points.insert(point).second) << node.level << ' ' << group.size();
          for (int a = 0; a < 3; ++a)
            EXPECT_LE(place(frame, point, a),
                      end_of(frame, a) + (most_snap_steps + 0.5) * frame.lattice.step);
        }
      }
    }
}

}  // namespace
}  // namespace voxweld
