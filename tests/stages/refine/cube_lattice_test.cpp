#include "stages/refine/cube_lattice.h"

#include <gtest/gtest.h>

#include <cmath>

#include "stages/stitch/lattice_plan.h"

namespace voxweld {
namespace {

// Wherever that is between two steps: a vertex there is rounded to the one or the other, and may lie
// beyond the far end where others took its place.
TEST(CubeLattice, HoldsBothEndsOfTheVolume) {
  // Of 31 samples that are .9985 apart the last cells end 7 steps before a power of two.
  for (const double spacing : {1.0, 0.3, 0.77, 0.9985, 12.5})
    for (const std::int64_t samples : {1, 30, 31, 62, 63, 64, 65, 127, 200}) {
      RefineFrame frame;
      frame.size = splat(samples);
      frame.spacing = {spacing, spacing, spacing};
      frame.lattice = plan_lattice({frame.size, frame.spacing, 0.01});
      const auto on_lattice = [&](double at) {
        return static_cast<std::int32_t>(
            std::lround((at - frame.lattice.origin[0]) / frame.lattice.step));
      };
      const std::int32_t first = on_lattice(-spacing);
      const std::int32_t last = on_lattice(static_cast<double>(samples) * spacing);
      for (const int pass : {0, 1, 2}) {
        SCOPED_TRACE(testing::Message() << spacing << " " << samples << " " << pass);
        const CubeLattice cubes(frame, pass);
        for (const LatticePoint& end : {LatticePoint{first, first, first}, {last, last, last}}) {
          EXPECT_TRUE(cubes.bounds().contains(end));
          const Index3 cube = cubes.cube_of(end);
          EXPECT_TRUE(cubes.box(cube).contains(end));
          EXPECT_TRUE(cubes.whole(cube).contains(end));
        }
        const LatticePoint beyond{last + most_snap_steps, last, last};
        EXPECT_TRUE(cubes.bounds().contains(beyond));
        EXPECT_LE(cubes.bounds().hi[0], last + 1 + most_snap_steps);
        EXPECT_LE(beyond[0], (1 << frame.lattice.bits) - 1) << "the lattice has no such place";
      }
    }
}

}  // namespace
}  // namespace voxweld
