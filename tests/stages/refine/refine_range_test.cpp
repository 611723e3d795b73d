// The driver of refine: what comes of a cube depends on the mesh alone.
#include <gtest/gtest.h>

#include "stages/refine/mesh_part.h"
#include "tests/stages/refine/torus.h"

namespace voxweld {
namespace {

using testing::same_mesh;
using testing::shapes_of;
using testing::shuffled;
using testing::torus;
using testing::torus_frame;

std::vector<CubeRange> cut_at(const std::vector<std::uint64_t>& codes) {
  std::vector<CubeRange> ranges(1);
  for (const std::uint64_t code : codes) {
    ranges.back().end = code;
    ranges.push_back({code, CubeRange{}.end});
  }
  return ranges;
}

const std::vector<std::vector<std::uint64_t>> cuts = {{}, {9}, {2, 7, 20, 41}};

// What a unit would be given: at home there, or near enough.
RefineMesh needed(const RefineMesh& mesh, const CubeLattice& cubes, const CubeRange& own) {
  std::vector<LatticeBox> near;
  const auto at_home = [&](std::size_t t) {
    return own.contains(cubes.code(home_of(mesh, t, cubes)));
  };
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    if (at_home(t)) near.push_back(cubes.box(home_of(mesh, t, cubes)));
  MeshGather part;
  part.add(mesh, [&](std::size_t t) {
    return at_home(t) ||
           std::ranges::any_of(near, [&](const LatticeBox& box) { return box.meets(mesh.box(t)); });
  });
  return part.take();
}

struct Refined {
  RefineMesh mesh;
  RefineCounts counts;
};

Refined refine_in(const RefineMesh& mesh, int pass, const std::vector<CubeRange>& ranges,
                  const RefineParameters& parameters, bool all_is_given) {
  const CubeLattice cubes(torus_frame(), pass);
  MeshGather whole;
  Refined refined;
  for (const CubeRange& range : ranges)
    whole.add(refine_range(all_is_given ? mesh : needed(mesh, cubes, range), cubes, range,
                           parameters, refined.counts));
  refined.mesh = whole.take();
  return refined;
}

constexpr RefineParameters collapsing{RefineMode::collapse, IntersectionRule::none, 2};

TEST(RefineRange, TheRangesDoNotMatter) {
  RefineMesh mesh = torus();
  for (const int pass : {0, 1}) {
    const Refined one = refine_in(mesh, pass, cut_at({}), collapsing, true);
    for (const auto& codes : cuts)
      for (const bool all_is_given : {true, false}) {
        const Refined other = refine_in(mesh, pass, cut_at(codes), collapsing, all_is_given);
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
    const Refined one = refine_in(mesh, pass, cut_at(cuts[2]), collapsing, true);
    for (const unsigned seed : {1U, 2U}) {
      const Refined other =
          refine_in(shuffled(mesh, seed), pass, cut_at(cuts[2]), collapsing, true);
      EXPECT_TRUE(same_mesh(one.mesh, other.mesh));
    }
  }
}

// Nothing intersects, and nothing is to be collapsed.
TEST(RefineRange, WhatNeedsNoRepairStaysAsItIs) {
  const RefineMesh mesh = torus();
  constexpr RefineParameters nothing{RefineMode::repair, IntersectionRule::ignore, 0};
  for (const int pass : {0, 1})
    for (const auto& codes : cuts) {
      const RefineMesh refined = refine_in(mesh, pass, cut_at(codes), nothing, false).mesh;
      EXPECT_EQ(shapes_of(refined), shapes_of(mesh));
      EXPECT_EQ(refined.samples.size(), mesh.samples.size());
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
