// Refine on the surfaces of random volumes: closed, without intersections, of the topology that they
// have before cells are collapsed.
// VOXWELD_VOLUMES: how many volumes (default 8).
#include <gtest/gtest.h>

#include <numeric>
#include <set>

#include "stages/exact/intersections.h"
#include "stages/refine/refine_range.h"
#include "stages/refine/repair.h"
#include "stages/refine/untie.h"
#include "tests/stages/refine/volume_mesh.h"
#include "tests/support/mesh_check.h"
#include "tests/support/random_volumes.h"

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

// Of the components of the surface before anything is simplified.
std::vector<std::int64_t> fine_eulers(const testing::RandomVolume& volume) {
  ContourParameters parameters;
  parameters.surface.isovalue = {0.0};
  parameters.simplify.enabled = false;
  return testing::component_eulers(
      testing::mesh_of(testing::volume_of(volume), parameters).mesh.triangles);
}

struct Case {
  testing::RandomVolume volume;
  double tolerance = 0.1;
  RefineMode mode = RefineMode::collapse;
  Topology topology = Topology::safe;
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
  const testing::VolumeMesh made =
      testing::mesh_of(testing::volume_of(c.volume), c.tolerance, c.topology);
  const RefineFrame& frame = made.frame;
  RefineMesh mesh = made.mesh;
  const auto eulers = fine_eulers(c.volume);
  EXPECT_EQ(testing::component_eulers(mesh.triangles), eulers);
  const std::size_t triangles = mesh.triangles.size(), pairs = pairs_of(mesh);
  const RefineParameters refine = testing::refining(frame, c.tolerance, c.mode);
  std::size_t left = pairs;
  testing::refine_all(mesh, frame, refine, [&](const RefineCounts& counts) {
    left = pairs_of(mesh);
    EXPECT_EQ(counts.pairs_left, left);
    if (c.mode == RefineMode::repair) {
      EXPECT_GE(mesh.triangles.size(), triangles * 9 / 10);
    }
  });
  const testing::WeldedMesh seen = welded(mesh);
  EXPECT_EQ(seen.vertices.size(), mesh.positions.size()) << "two vertices at one place";
  EXPECT_TRUE(testing::check_edges(seen.triangles).closed());
  EXPECT_TRUE(testing::nonmanifold_vertices(seen.triangles).empty());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) EXPECT_FALSE(has_no_area(mesh.shape(t)));
  EXPECT_EQ(testing::component_eulers(seen.triangles), eulers);
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

// Cubes of both passes hold all of it, and it is more than is done at once. (Cut in the same places
// in both passes it kept 21 pairs.)
TEST(RefineVolume, SmallButDense) {
  Totals totals;
  check({{30, true, 1}, 0.05, RefineMode::collapse}, totals);
  EXPECT_GT(totals.before, 10000u);
  EXPECT_LE(totals.left, 2u);
}

// What lies at borders of both passes is fixed in both. Small cubes have much of that.
TEST(RefineVolume, MendReachesWhatThePassesMayNotChange) {
  testing::VolumeMesh made = testing::mesh_of_volume({34, true, 7}, 0.2);
  made.frame.level = 4;
  const RefineParameters refine = testing::refining(made.frame, 0.2, RefineMode::collapse);
  RefineMesh mesh = made.mesh;
  std::vector<std::uint64_t> left;
  testing::refine_all(mesh, made.frame, refine,
                      [&](const RefineCounts& counts) { left.push_back(counts.pairs_left); });
  ASSERT_EQ(left.size(), 3u);
  EXPECT_GT(left[1], 20u);
  EXPECT_LT(left[2] * 3, left[1]);
  EXPECT_EQ(pairs_of(mesh), left[2]);
}

// Nothing is done where nothing intersects, and what was collapsed stays.
TEST(RefineVolume, MendLeavesWhatIsSoundAsItIs) {
  const testing::VolumeMesh made = testing::mesh_of_volume({40, false, 3}, 0.1);
  const RefineParameters refine = testing::refining(made.frame, 0.1, RefineMode::mend);
  RefineMesh mesh = made.mesh;
  RefineCounts counts;
  for (int pass = 0; pass < refine_passes; ++pass)
    mesh = refine_range(mesh, CubeLattice(made.frame, pass), {},
                        testing::refining(made.frame, 0.1, RefineMode::collapse), counts);
  ASSERT_TRUE(mesh.intersecting.empty());
  EXPECT_TRUE(mend_boxes({}, made.frame).empty());
  RefineCounts none;
  const LatticeBox all = LatticeBox::around(mesh.positions);
  const RefineMesh after = mend_box(mesh, all, refine, none);
  EXPECT_EQ(none.collapses + none.moves + none.flips + none.pairs_before + none.pairs_left, 0u);
  for (const std::uint64_t more : none.distances) EXPECT_EQ(more, 0u);
  const auto ids = [](const RefineMesh& m) {
    std::vector<std::array<VertexId, 3>> list;
    for (std::size_t t = 0; t < m.triangles.size(); ++t) list.push_back(m.ids_of(t));
    std::sort(list.begin(), list.end());
    return list;
  };
  EXPECT_EQ(ids(after), ids(mesh));
}

// Every single change around them leaves as many pairs or more.
TEST(RefineVolume, UntiesWhatNoSingleChangeMends) {
  const testing::VolumeMesh made = testing::mesh_of_volume({12, true, 13}, 0.02);
  const RefineParameters refine = testing::refining(made.frame, 0.02, RefineMode::mend);
  EditMesh edit(made.mesh, LatticeBox::around(made.mesh.positions));
  edit.set_intersecting(edit.find_intersecting());
  RefineCounts counts;
  repair_intersections(edit, refine, counts, RepairEffort::thorough);
  EXPECT_GT(edit.count_pairs(), 0u);
  RefineCounts untied;
  std::set<Knot> tied;
  untie_intersections(edit, refine, tied, untied);
  EXPECT_EQ(edit.count_pairs(), 0u);
  EXPECT_GT(untied.moves + untied.flips + untied.collapses, 1u);
  const RefineMesh mesh = std::move(edit).take();
  EXPECT_EQ(pairs_of(mesh), 0u);
  EXPECT_TRUE(mesh.intersecting.empty());
  const testing::WeldedMesh seen = welded(mesh);
  EXPECT_TRUE(testing::check_edges(seen.triangles).closed());
  EXPECT_TRUE(testing::nonmanifold_vertices(seen.triangles).empty());
  EXPECT_EQ(testing::euler_characteristic(seen.triangles),
            testing::euler_characteristic(made.mesh.triangles));
}

// What was changed is all that is looked around.
TEST(RefineVolume, RepairsAroundWhatWasChanged) {
  const testing::VolumeMesh made = testing::mesh_of_volume({12, true, 13}, 0.02);
  const RefineParameters refine = testing::refining(made.frame, 0.02, RefineMode::mend);
  const auto unrepaired = [&] {
    EditMesh edit(made.mesh, LatticeBox::around(made.mesh.positions));
    edit.set_intersecting(edit.find_intersecting());
    return edit;
  };
  const auto changes = [](const RefineCounts& c) { return c.moves + c.flips + c.collapses; };
  EditMesh all = unrepaired(), nothing = unrepaired(), everything = unrepaired();
  std::vector<std::uint32_t> vertices(all.vertices());
  std::iota(vertices.begin(), vertices.end(), 0U);
  RefineCounts of_all, of_nothing, of_everything;
  repair_intersections(all, refine, of_all, RepairEffort::thorough);
  repair_around(nothing, {}, refine, of_nothing, RepairEffort::thorough);
  repair_around(everything, vertices, refine, of_everything, RepairEffort::thorough);
  EXPECT_EQ(changes(of_nothing), 0u);
  EXPECT_GT(changes(of_all), 0u);
  EXPECT_EQ(changes(of_everything), changes(of_all));
  EXPECT_EQ(std::move(everything).take().positions, std::move(all).take().positions);
}

// They are known by what does not depend on the mesh at hand.
TEST(RefineVolume, KnotsThatNothingHelpsWithAreLeftOut) {
  const testing::VolumeMesh made = testing::mesh_of_volume({12, true, 13}, 0.02);
  const auto repaired = [&](const RefineParameters& refine) {
    EditMesh edit(made.mesh, LatticeBox::around(made.mesh.positions));
    edit.set_intersecting(edit.find_intersecting());
    RefineCounts counts;
    repair_intersections(edit, refine, counts, RepairEffort::thorough);
    return edit;
  };
  const RefineParameters refine = testing::refining(made.frame, 0.02, RefineMode::mend);
  RefineParameters stiff = refine;
  stiff.reach = 0;  // nothing may be tried
  std::set<Knot> tied;
  RefineCounts none;
  EditMesh edit = repaired(refine);
  const std::size_t pairs = edit.count_pairs();
  untie_intersections(edit, stiff, tied, none);
  EXPECT_EQ(edit.count_pairs(), pairs);
  ASSERT_FALSE(tied.empty());
  const std::set<Knot> known = tied;
  EditMesh same = repaired(refine);
  untie_intersections(same, refine, tied, none);
  EXPECT_EQ(same.count_pairs(), pairs);
  EXPECT_EQ(tied, known);
  EXPECT_EQ(none.moves + none.flips + none.collapses, 0u);
}

TEST(RefineVolume, RandomVolumesStaySoundAndLoseTheirIntersections) {
  const unsigned count = testing::volumes_to_try(8);
  Totals totals;
  for (unsigned seed = 0; seed < count; ++seed) {
    const std::int64_t side = 24 + seed * 7 % 25;
    const bool noise = seed % 4 == 3;
    for (const double tolerance : {0.05, 0.5, 1e6})
      check({{noise ? 24 : side, noise, seed},
             tolerance,
             seed % 2 == 0 ? RefineMode::collapse : RefineMode::repair,
             Topology::manifold},
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
