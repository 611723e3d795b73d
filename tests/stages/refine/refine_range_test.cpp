// The driver of refine: what comes of a cube depends on the mesh alone.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <optional>

#include "tests/stages/refine/refine_ranges.h"
#include "tests/stages/refine/torus.h"
#include "tests/stages/refine/volume_mesh.h"

namespace voxweld {
namespace {

using testing::cut_at;
using testing::refine_in;
using testing::Refined;
using testing::same_mesh;
using testing::shapes_of;
using testing::shuffled;
using testing::torus;
using testing::torus_frame;

const std::vector<std::vector<std::uint64_t>> cuts = {{}, {9}, {2, 7, 20, 41}};

constexpr RefineParameters collapsing{RefineMode::collapse, IntersectionRule::none, 2};

TEST(RefineRange, TheRangesDoNotMatter) {
  RefineMesh mesh = torus();
  for (const int pass : {0, 1}) {
    const Refined one = refine_in(mesh, torus_frame(), pass, cut_at({}), collapsing, true);
    for (const auto& codes : cuts)
      for (const bool all_is_given : {true, false}) {
        const Refined other =
            refine_in(mesh, torus_frame(), pass, cut_at(codes), collapsing, all_is_given);
        EXPECT_TRUE(same_mesh(one.mesh, other.mesh)) << pass << " " << codes.size();
        EXPECT_EQ(one.counts.cubes, other.counts.cubes);
        EXPECT_EQ(one.counts.collapses, other.counts.collapses);
        EXPECT_EQ(one.counts.distances, other.counts.distances);
      }
    mesh = one.mesh;
  }
}

TEST(RefineRange, TheOrderOfTheMeshDoesNotMatter) {
  const RefineMesh mesh = torus();
  for (const int pass : {0, 1}) {
    const Refined one = refine_in(mesh, torus_frame(), pass, cut_at(cuts[2]), collapsing, true);
    for (const unsigned seed : {1U, 2U}) {
      const Refined other =
          refine_in(shuffled(mesh, seed), torus_frame(), pass, cut_at(cuts[2]), collapsing, true);
      EXPECT_TRUE(same_mesh(one.mesh, other.mesh));
    }
  }
}

// A cube of so many triangles is done in parts, some of them at the same time.
TEST(RefineRange, ThreadsDoNotMatter) {
  const testing::VolumeMesh made = testing::mesh_of_volume({30, true, 1}, 0.05);
  ASSERT_GT(made.mesh.triangles.size(), std::size_t{1} << 16);
  RefineParameters parameters = testing::refining(made.frame, 0.05, RefineMode::collapse);
  parameters.intersections = IntersectionRule::ignore;
  std::optional<Refined> one;
  for (const std::size_t threads : {1U, 4U}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    const Refined made_so = refine_in(made.mesh, made.frame, 0, cut_at({}), parameters, true);
    if (!one) one = made_so;
    EXPECT_TRUE(same_mesh(one->mesh, made_so.mesh));
    EXPECT_EQ(one->counts.collapses, made_so.counts.collapses);
    EXPECT_EQ(one->counts.distances, made_so.counts.distances);
  }
  EXPECT_GT(one->counts.collapses, 1000u);
}

// Nothing intersects, and nothing is to be collapsed.
TEST(RefineRange, WhatNeedsNoRepairStaysAsItIs) {
  const RefineMesh mesh = torus();
  constexpr RefineParameters nothing{RefineMode::repair, IntersectionRule::ignore, 0};
  for (const int pass : {0, 1})
    for (const auto& codes : cuts) {
      const RefineMesh refined =
          refine_in(mesh, torus_frame(), pass, cut_at(codes), nothing, false).mesh;
      EXPECT_EQ(shapes_of(refined), shapes_of(mesh));
      EXPECT_EQ(refined.samples.size(), mesh.samples.size());
    }
}

// What the tolerance leaves that is tried last is what a pass with it leaves: tolerances before it do
// little to that. Ranges add up.
TEST(RefineRange, ASurveyCountsWhatAPassLeaves) {
  const RefineMesh mesh = torus();
  const std::vector<double> tolerances = {0.001 * collapsing.tolerance, 0.1 * collapsing.tolerance,
                                          collapsing.tolerance};
  for (const int pass : {0, 1}) {
    const CubeLattice cubes(torus_frame(), pass), others(torus_frame(), 1 - pass);
    const CollapseSurvey whole = survey_range(mesh, cubes, others, {}, collapsing, tolerances);
    EXPECT_EQ(whole.all(), mesh.triangles.size());
    EXPECT_LE(whole.held, whole.fixed);
    EXPECT_TRUE(std::ranges::is_sorted(whole.left, std::greater<>()));
    const Refined one = refine_in(mesh, torus_frame(), pass, cut_at({}), collapsing, true);
    const auto left = static_cast<double>(one.mesh.triangles.size());
    EXPECT_NEAR(static_cast<double>(whole.left.back() + whole.fixed), left, 0.05 * left);
    for (const auto& codes : cuts) {
      CollapseSurvey sum;
      for (const CubeRange& range : cut_at(codes))
        sum.add(survey_range(testing::needed(mesh, cubes, range), cubes, others, range, collapsing,
                             tolerances));
      EXPECT_EQ(sum, whole);
    }
  }
}

TEST(RefineRange, OfNothingIsNothing) {
  RefineCounts counts;
  const RefineMesh none = refine_range({}, CubeLattice(torus_frame(), 0), {}, collapsing, counts);
  EXPECT_TRUE(none.triangles.empty());
  EXPECT_EQ(counts.cubes, 0u);
}

}  // namespace
}  // namespace voxweld
