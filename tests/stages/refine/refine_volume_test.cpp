// Refine on the surfaces of random volumes: closed, without intersections, of the same topology.
// VOXWELD_REFINE_VOLUMES: how many volumes (default 8).
#include <gtest/gtest.h>

#include <cstdlib>

#include "stages/exact/intersections.h"
#include "stages/refine/refine_range.h"
#include "tests/stages/refine/volume_mesh.h"
#include "tests/support/mesh_check.h"

namespace voxweld {
namespace {

std::size_t pairs_of(const RefineMesh& mesh) {
  std::size_t pairs = 0;
  each_intersection({mesh.positions, mesh.triangles},
                    [&](std::uint32_t, std::uint32_t) { ++pairs; });
  return pairs;
}

// Vertices by their places alone, as who reads the files has them.
testing::WeldedMesh welded(const RefineMesh& mesh) {
  std::vector<Vec3> places;
  for (const LatticePoint& p : mesh.positions)
    places.push_back(
        {static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2])});
  return testing::weld(places, mesh.triangles);
}

struct Case {
  testing::RandomVolume volume;
  double tolerance = 0.1;
  RefineMode mode = RefineMode::collapse;
};

std::ostream& operator<<(std::ostream& out, const Case& c) {
  return out << (c.volume.noise ? "noise " : "smooth ") << c.volume.side << " seed "
             << c.volume.seed << " tolerance " << c.tolerance
             << (c.mode == RefineMode::repair ? " repair" : " collapse");
}

struct Totals {
  std::uint64_t volumes = 0, before = 0, left = 0;
};

void check(const Case& c, Totals& totals) {
  SCOPED_TRACE(::testing::PrintToString(c));
  const testing::VolumeMesh made = testing::mesh_of_volume(c.volume, c.tolerance);
  const RefineFrame& frame = made.frame;
  RefineMesh mesh = made.mesh;
  const auto euler = testing::euler_characteristic(mesh.triangles);
  const auto components = testing::connected_components(mesh.triangles);
  const std::size_t triangles = mesh.triangles.size(), pairs = pairs_of(mesh);
  const RefineParameters refine = testing::refining(frame, c.tolerance, c.mode);
  std::size_t left = pairs;
  for (int pass = 0; pass < refine_passes; ++pass) {
    RefineCounts counts;
    mesh = refine_range(mesh, CubeLattice(frame, pass), {}, testing::of_pass(pass, refine), counts);
    EXPECT_EQ(counts.pairs_before, left);
    left = pairs_of(mesh);
    EXPECT_EQ(counts.pairs_left, left);
    if (c.mode == RefineMode::repair) {
      EXPECT_GE(mesh.triangles.size(), triangles * 9 / 10);
    }
  }
  const testing::WeldedMesh seen = welded(mesh);
  EXPECT_EQ(seen.vertices.size(), mesh.positions.size()) << "two vertices at one place";
  EXPECT_TRUE(testing::check_edges(seen.triangles).closed());
  EXPECT_TRUE(testing::nonmanifold_vertices(seen.triangles).empty());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) EXPECT_FALSE(has_no_area(mesh.shape(t)));
  EXPECT_EQ(testing::euler_characteristic(seen.triangles), euler);
  EXPECT_EQ(testing::connected_components(seen.triangles), components);
  EXPECT_LE(mesh.triangles.size(), triangles);
  totals.volumes += 1;
  totals.before += pairs;
  totals.left += left;
  if (left > 0) std::printf("%zu left: %s\n", left, ::testing::PrintToString(c).c_str());
}

// A triangle that intersected went, and those changed with it came upon others.
TEST(RefineVolume, WhatIsLeftIsCounted) {
  Totals totals;
  check({{24, true, 55}, 0.5, RefineMode::repair}, totals);
}

// What lies at a border of each of the first two passes is fixed in both. Small cubes have much of that.
TEST(RefineVolume, AThirdPassMendsWhatTwoMayNotChange) {
  testing::VolumeMesh made = testing::mesh_of_volume({34, true, 7}, 0.2);
  made.frame.level = 4;
  const RefineParameters refine = testing::refining(made.frame, 0.2, RefineMode::collapse);
  std::vector<RefineCounts> counts(refine_passes);
  RefineMesh mesh = made.mesh;
  for (int pass = 0; pass < refine_passes; ++pass)
    mesh = refine_range(mesh, CubeLattice(made.frame, pass), {}, testing::of_pass(pass, refine),
                        counts[static_cast<std::size_t>(pass)]);
  EXPECT_GT(counts[1].pairs_left, 20u);
  EXPECT_EQ(counts[2].pairs_before, counts[1].pairs_left);
  EXPECT_LT(counts[2].pairs_left * 3, counts[1].pairs_left);
  EXPECT_EQ(pairs_of(mesh), counts[2].pairs_left);
  EXPECT_GT(counts[2].moves + counts[2].flips + counts[2].collapses, 0u);
}

// Nothing is done where nothing intersects, and what was collapsed stays.
TEST(RefineVolume, AThirdPassLeavesWhatIsSoundAsItIs) {
  const testing::VolumeMesh made = testing::mesh_of_volume({40, false, 3}, 0.1);
  RefineMesh mesh = made.mesh;
  const RefineParameters refine = testing::refining(made.frame, 0.1, RefineMode::collapse);
  for (int pass = 0; pass < 2; ++pass) {
    RefineCounts counts;
    mesh = refine_range(mesh, CubeLattice(made.frame, pass), {}, refine, counts);
    if (pass == 1) {
      ASSERT_EQ(counts.pairs_left, 0u);
    }
  }
  RefineCounts counts;
  const RefineMesh after =
      refine_range(mesh, CubeLattice(made.frame, 2), {}, testing::of_pass(2, refine), counts);
  EXPECT_EQ(counts.collapses + counts.moves + counts.flips, 0u);
  EXPECT_EQ(after.triangles.size(), mesh.triangles.size());
  const auto ids = [](const RefineMesh& m) {
    std::vector<std::array<VertexId, 3>> all;
    for (std::size_t t = 0; t < m.triangles.size(); ++t) all.push_back(m.ids_of(t));
    std::sort(all.begin(), all.end());
    return all;
  };
  EXPECT_EQ(ids(after), ids(mesh));
}

TEST(RefineVolume, RandomVolumesStaySoundAndLoseTheirIntersections) {
  const char* wanted = std::getenv("VOXWELD_REFINE_VOLUMES");
  const unsigned count = wanted != nullptr ? static_cast<unsigned>(std::atoi(wanted)) : 8;
  Totals totals;
  for (unsigned seed = 0; seed < count; ++seed) {
    const std::int64_t side = 24 + seed * 7 % 25;
    const bool noise = seed % 4 == 3;
    for (const double tolerance : {0.05, 0.5, 1e6})
      check({{noise ? 24 : side, noise, seed},
             tolerance,
             seed % 2 == 0 ? RefineMode::collapse : RefineMode::repair},
            totals);
  }
  std::printf("%llu meshes, pairs %llu -> %llu\n", static_cast<unsigned long long>(totals.volumes),
              static_cast<unsigned long long>(totals.before),
              static_cast<unsigned long long>(totals.left));
  // Some are knots that no single change unties.
  EXPECT_LE(totals.left * 10000, totals.before);
}

}  // namespace
}  // namespace voxweld
