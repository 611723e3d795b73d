// Holds refine_bytes against every byte that refining allocates.
#include <gtest/gtest.h>

#include <random>

#include "stages/refine/refine_range.h"
#include "tests/stages/refine/volume_mesh.h"
#include "tests/support/allocation_count.h"

namespace voxweld {
namespace {

void expect_enough(const testing::RandomVolume& volume) {
  const testing::VolumeMesh made = testing::mesh_of_volume(volume, 0.05);
  RefineMesh mesh = made.mesh;
  RefineParameters parameters;
  parameters.tolerance = 0.1 / made.frame.lattice.step;
  parameters.reach = 1 / made.frame.lattice.step;
  parameters.intersections = IntersectionRule::report;
  for (int pass = 0; pass < refine_passes; ++pass) {
    const MeshSize size{mesh.positions.size(), mesh.triangles.size(),
                        mesh.samples.size() + mesh.positions.size()};
    const CubeLattice cubes(made.frame, pass);
    RefineCounts counts;
    const std::uint64_t before = testing::live_bytes();
    testing::forget_peak();
    RefineMesh refined = refine_range(mesh, cubes, {}, parameters, counts);
    const std::uint64_t taken = testing::peak_bytes() - before;
    EXPECT_LE(taken, refine_bytes(size, size)) << size.triangles;
    EXPECT_GE(taken * 4, refine_bytes(size, size)) << size.triangles;
    mesh = std::move(refined);
  }
}

TEST(RefineMemory, OfANoisyCubeIsSaidBefore) {
  expect_enough({40, true, 3});  // more triangles than are done at once
}
TEST(RefineMemory, OfASmoothSurfaceIsSaidBefore) {
  expect_enough({80, false, 2});
}

}  // namespace
}  // namespace voxweld
