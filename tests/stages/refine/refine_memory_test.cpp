// Holds refine_bytes against every byte that refining allocates.
#include <gtest/gtest.h>

#include <random>

#include "stages/refine/coarsen.h"
#include "stages/refine/refine_range.h"
#include "tests/stages/refine/volume_mesh.h"
#include "tests/support/allocation_count.h"
#include "tests/support/label_cases.h"
#include "tests/support/label_complex.h"

namespace voxweld {
namespace {

// With tolerances as large as there are.
void expect_survey_enough(const RefineMesh& mesh, const RefineFrame& frame, int pass,
                          const RefineParameters& parameters, std::uint64_t most) {
  const std::vector<double> tolerances = {0.01 * parameters.reach, 64 * parameters.reach};
  const std::uint64_t before = testing::live_bytes();
  testing::forget_peak();
  survey_range(mesh, CubeLattice(frame, pass), CubeLattice(frame, 1 - pass), {}, parameters,
               tolerances);
  EXPECT_LE(testing::peak_bytes() - before, most) << mesh.triangles.size();
}

void expect_enough(const testing::VolumeMesh& made,
                   IntersectionRule rule = IntersectionRule::report) {
  RefineMesh mesh = made.mesh;
  RefineParameters parameters;
  parameters.tolerance = 0.1 / made.frame.lattice.step;
  parameters.reach = 1 / made.frame.lattice.step;
  parameters.intersections = rule;
  for (int pass = 0; pass < refine_passes; ++pass) {
    const MeshSize size{mesh.positions.size(), mesh.triangles.size(),
                        mesh.samples.size() + mesh.positions.size(), mesh.sides.size()};
    const CubeLattice cubes(made.frame, pass);
    RefineCounts counts;
    const std::uint64_t before = testing::live_bytes();
    testing::forget_peak();
    RefineMesh refined = refine_range(mesh, cubes, {}, parameters, counts);
    const std::uint64_t taken = testing::peak_bytes() - before;
    EXPECT_LE(taken, refine_bytes(size, size)) << size.triangles;
    EXPECT_GE(taken * 4, refine_bytes(size, size)) << size.triangles;
    if (pass < 2)
      expect_survey_enough(mesh, made.frame, pass, parameters, refine_bytes(size, size));
    mesh = std::move(refined);
  }
}

// Of the last node of a tree, and of one whose border is fixed.
void expect_enough_for_levels(const testing::VolumeMesh& made) {
  RefineParameters parameters;
  parameters.tolerance = 0.1 / made.frame.lattice.step;
  parameters.reach = 1 / made.frame.lattice.step;
  const MeshSize size{made.mesh.positions.size(), made.mesh.triangles.size(),
                      made.mesh.samples.size(), made.mesh.sides.size()};
  for (const bool all : {true, false})
    for (const int doublings : {2, 5}) {
      RefineMesh mesh = made.mesh;
      RefineCounts counts;
      const std::uint64_t before = testing::live_bytes();
      testing::forget_peak();
      const RefineMesh coarse = coarsen(std::move(mesh), made.frame,
                                        {{8, {0, 0, 0}}, all, doublings}, parameters, counts);
      const std::uint64_t taken = testing::peak_bytes() - before;
      EXPECT_LE(taken, coarsen_bytes(size)) << size.triangles << " " << all << " " << doublings;
      EXPECT_GE(taken * 4, coarsen_bytes(size)) << size.triangles << " " << all << " " << doublings;
      EXPECT_LT(coarse.triangles.size(), size.triangles);
    }
}

TEST(RefineMemory, OfCoarserLevelsIsSaidBefore) {
  expect_enough_for_levels(testing::mesh_of_volume({40, true, 3}, 0.05));
  expect_enough_for_levels(testing::mesh_of_volume({80, false, 2}, 0.05));
}

TEST(RefineMemory, OfANoisyCubeIsSaidBefore) {
  expect_enough(
      testing::mesh_of_volume({40, true, 3}, 0.05));  // more triangles than are done at once
}
TEST(RefineMemory, OfNoiseThatIsRepairedIsSaidBefore) {
  expect_enough(testing::mesh_of_volume({40, true, 3}, 0.05), IntersectionRule::none);
}
TEST(RefineMemory, OfASmoothSurfaceIsSaidBefore) {
  expect_enough(testing::mesh_of_volume({80, false, 2}, 0.05));
}
TEST(RefineMemory, BetweenLabelsIsSaidBefore) {
  for (const testing::MemoryVolume& volume :
       {testing::noise({24, 24, 24}, 6, 1), testing::voronoi(90, 30, 8, 2)})
    expect_enough(testing::mesh_of(volume, testing::shared_labels(0.05)));
}

}  // namespace
}  // namespace voxweld
