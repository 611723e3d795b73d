// What intersects, found range by range: what the plain test of all pairs finds, whatever the ranges.
#include "stages/refine/find_pairs.h"

#include <gtest/gtest.h>

#include <random>
#include <set>

#include "stages/exact/intersections.h"
#include "stages/refine/box_pairs.h"
#include "tests/stages/refine/refine_ranges.h"
#include "tests/stages/refine/volume_mesh.h"

namespace voxweld {
namespace {

using Ids = std::array<VertexId, 3>;
using IdPair = std::pair<Ids, Ids>;

std::vector<IdPair> plain_pairs(const RefineMesh& mesh) {
  std::vector<IdPair> pairs;
  each_intersection({mesh.positions, mesh.triangles}, [&](std::uint32_t a, std::uint32_t b) {
    pairs.push_back({mesh.ids_of(a), mesh.ids_of(b)});
  });
  return pairs;
}

// Moves some vertices by some cells, so that there is something to find.
void disturb(RefineMesh& mesh, const RefineFrame& frame, int one_of, unsigned seed) {
  std::mt19937 random(seed);
  const auto reach = static_cast<std::int32_t>(2 / frame.lattice.step);
  const LatticeBox all = CubeLattice(frame, 0).bounds();
  for (LatticePoint& p : mesh.positions) {
    if (random() % static_cast<unsigned>(one_of) != 0) continue;
    for (std::size_t a = 0; a < 3; ++a)
      p[a] = std::clamp(
          p[a] + static_cast<std::int32_t>(random() % static_cast<unsigned>(2 * reach)) - reach,
          all.lo[a], all.hi[a]);
  }
}

// What a unit is given: what is at home there, and of the rest what leaves its cube and is near.
RefineMesh given(const RefineMesh& mesh, const CubeLattice& cubes, const CubeRange& own) {
  std::vector<LatticeBox> near;
  const auto at_home = [&](std::size_t t) {
    return own.contains(cubes.code(home_of(mesh, t, cubes)));
  };
  const auto leaves = [&](std::size_t t) {
    const LatticeBox box = mesh.box(t);
    return cubes.cube_of(box.lo) != cubes.cube_of(box.hi);
  };
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    if (at_home(t)) {
      const LatticeBox home = cubes.box(home_of(mesh, t, cubes));
      if (std::ranges::find(near, home) == near.end()) near.push_back(home);
      if (leaves(t)) near.push_back(mesh.box(t));
    }
  MeshGather part;
  part.add(mesh, [&](std::size_t t) {
    return at_home(t) || (leaves(t) && std::ranges::any_of(near, [&](const LatticeBox& box) {
                            return box.meets(mesh.box(t));
                          }));
  });
  return part.take();
}

// In all ranges. Returns how many pairs there are.
std::size_t expect_all_found(const RefineMesh& mesh, const RefineFrame& frame,
                             const std::vector<CubeRange>& ranges) {
  const CubeLattice cubes(frame, 0);
  std::set<Ids> found;
  std::uint64_t pairs = 0;
  for (const CubeRange& range : ranges) {
    const RefineMesh part = given(mesh, cubes, range);
    const FoundPairs some = find_range_pairs(part, cubes, range);
    pairs += some.pairs;
    EXPECT_TRUE(std::ranges::is_sorted(some.intersecting));
    for (const std::uint32_t t : some.intersecting) {
      EXPECT_TRUE(range.contains(cubes.code(home_of(part, t, cubes))));
      EXPECT_TRUE(found.insert(part.ids_of(t)).second) << "twice";
    }
  }
  std::set<Ids> plain;
  const std::vector<IdPair> all = plain_pairs(mesh);
  for (const auto& [a, b] : all) {
    EXPECT_TRUE(found.contains(a) || found.contains(b));
    plain.insert(a);
    plain.insert(b);
  }
  EXPECT_TRUE(std::ranges::includes(plain, found)) << "one that intersects nothing";
  EXPECT_EQ(pairs, all.size());
  return all.size();
}

const std::vector<CubeRange> one_range = {CubeRange{}};

TEST(FindPairs, WhatThePlainTestFinds) {
  std::size_t pairs = 0;
  for (const bool noise : {false, true})
    for (const int one_of : {20, 1'000'000})
      for (unsigned seed = 0; seed < 2; ++seed) {
        testing::VolumeMesh made =
            testing::mesh_of_volume({noise ? 11 : 22, noise, seed}, noise ? 0.02 : 0.3);
        disturb(made.mesh, made.frame, one_of, seed);
        // Small cubes, so that many triangles leave theirs.
        made.frame.level = 3;
        pairs += expect_all_found(made.mesh, made.frame, one_range);
        expect_all_found(made.mesh, made.frame, testing::cut_at({1, 3, 8, 9}));
      }
  EXPECT_GT(pairs, 1000u);
}

TEST(FindPairs, WhereSeveralLabelsMeet) {
  // Three sheets that meet in the edge 0-1, like the pages of a book: the first and the third lie over
  // each other seen from above, and have nothing in common. The fourth cuts the second.
  RefineMesh mesh;
  mesh.positions = {{100, 100, 100}, {200, 100, 100}, {150, 200, 100}, {150, 10, 100},
                    {150, 200, 180}, {150, 150, 60},  {140, 150, 140}, {160, 150, 140}};
  for (std::uint64_t v = 0; v < mesh.positions.size(); ++v) mesh.ids.push_back(VertexId{v});
  mesh.triangles = {{0, 1, 2}, {0, 3, 1}, {0, 1, 4}, {5, 6, 7}};
  mesh.sides = {{1, 2}, {1, 2}, {2, 3}, {3, 4}};
  const RefineFrame frame{plan_lattice({splat(64), {1, 1, 1}, 0.01}), {1, 1, 1}, {}, splat(64)};
  EXPECT_EQ(expect_all_found(mesh, frame, one_range), plain_pairs(mesh).size());
  EXPECT_GT(plain_pairs(mesh).size(), 0u);
}

TEST(FindPairs, NothingInNothing) {
  const RefineFrame frame{plan_lattice({splat(64), {1, 1, 1}, 0.01}), {1, 1, 1}, {}, splat(64)};
  EXPECT_EQ(find_range_pairs({}, CubeLattice(frame, 0), {}).pairs, 0u);
}

// The quick search for pairs of boxes against all pairs.
TEST(BoxPairs, AllThatMeetOnce) {
  std::mt19937 random(5);
  for (const std::size_t count : {0u, 1u, 2u, 8u, 9u, 64u, 65u, 700u})
    for (const std::int32_t spread : {40, 4000, 4'000'000}) {
      std::vector<LatticeBox> boxes;
      for (std::size_t i = 0; i < count; ++i) {
        LatticeBox box;
        for (std::size_t a = 0; a < 3; ++a) {
          box.lo[a] = static_cast<std::int32_t>(random() % static_cast<unsigned>(spread));
          box.hi[a] =
              box.lo[a] + static_cast<std::int32_t>(random() % (static_cast<unsigned>(spread) / 8));
        }
        boxes.push_back(box);
      }
      std::set<std::pair<std::uint32_t, std::uint32_t>> found;
      std::size_t calls = 0;
      BoxPairs(boxes).each([&](std::uint32_t a, std::uint32_t b) {
        EXPECT_LT(a, b);
        ++calls;
        found.emplace(a, b);
      });
      EXPECT_EQ(calls, found.size());
      std::size_t meeting = 0;
      for (std::uint32_t a = 0; a < count; ++a)
        for (std::uint32_t b = a + 1; b < count; ++b) {
          if (!boxes[a].meets(boxes[b])) continue;
          ++meeting;
          EXPECT_TRUE(found.contains({a, b}));
        }
      // Others are a few, as corners are rounded.
      EXPECT_LE(found.size(), meeting + meeting / 4 + 4);
    }
}

}  // namespace
}  // namespace voxweld
