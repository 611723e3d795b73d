// Parts of meshes against the whole: the same flips, crossings and sides, bit for bit.
#include "stages/solids/local_mesh.h"

#include <gtest/gtest.h>

#include <cstring>

#include "tests/stages/sampled_solid.h"

namespace voxweld {
namespace {

using testing::Sides;
using testing::sides_of;

MeshBin bin_of(const TriangleMesh& mesh, const MeshSolid& whole, const VolumeFrame& frame,
               const Box3& samples) {
  MeshBin bin;
  for (const auto& t : mesh.triangles) {
    std::array<Index3, 3> corners;
    for (std::size_t i = 0; i < 3; ++i)
      corners[i] = snapped_corner(mesh.vertices[t[i]], frame.spacing);
    if (triangle_reaches(corners, samples))
      bin.corners.insert(bin.corners.end(), corners.begin(), corners.end());
  }
  bin.first.resize(row_words(samples));
  Box3 layer = samples;
  layer.hi.x = layer.lo.x + 1;
  whole.each_flip(layer, [&](const LatticeSolid::Flip& flip) {
    const std::uint64_t row = row_number(samples, flip.y, flip.z);
    bin.first[row / 64] ^= std::uint64_t{1} << (row % 64);
  });
  return bin;
}

bool same_bits(const LatticeSolid::Crossing& a, const LatticeSolid::Crossing& b) {
  return std::memcmp(&a, &b, sizeof a) == 0;
}

void expect_same_crossings(const MeshSolid& whole, const LocalMesh& local, const Box3& samples) {
  const Sides inside = sides_of(whole, samples);
  const auto at = [&](Index3 s) { return inside[testing::index_in(samples, s)] != 0; };
  each_index(samples, [&](Index3 low) {
    for (int axis = 0; axis < 3; ++axis) {
      Index3 high = low;
      if (++high[axis] == samples.hi[axis] || at(low) == at(high)) continue;
      EXPECT_TRUE(
          same_bits(whole.crossing(axis, low, at(low)), local.crossing(axis, low, at(low))));
    }
  });
}

struct Counts {
  int reached = 0, inside = 0, outside = 0;
};

// Every brick of 8 cells, with its halo.
Counts expect_same(const TriangleMesh& mesh, const VolumeFrame& frame) {
  const MeshSolid whole(mesh, frame, {});
  Counts counts;
  const Index3 last = frame.size - splat(1);
  each_index(Index3{last.x / 8 + 1, last.y / 8 + 1, last.z / 8 + 1}, [&](Index3 brick) {
    const Index3 origin = brick * 8;
    const Box3 samples = intersect({origin - splat(2), origin + splat(9)}, Box3{{}, frame.size});
    MeshBin bin = bin_of(mesh, whole, frame, samples);
    const bool empty = bin.corners.empty();
    const std::optional<bool> side = whole.side(samples);
    EXPECT_EQ(side.has_value(), empty);
    ++(!empty ? counts.reached : *side ? counts.inside : counts.outside);
    const LocalMesh local(std::move(bin), {samples, frame.spacing, whole.bounds(), {}});
    const Sides expected = sides_of(whole, samples);
    EXPECT_EQ(sides_of(local, samples), expected);
    if (side) {
      EXPECT_EQ(expected, Sides(expected.size(), *side ? 1 : 0));
    }
    Box3 part = samples;
    part.lo = part.lo + Index3{3, 2, 1};
    part.hi = part.hi - Index3{1, 2, 3};
    if (!part.empty()) {
      EXPECT_EQ(sides_of(local, part), sides_of(whole, part));
    }
    expect_same_crossings(whole, local, samples);
    // The sides further on.
    const std::int64_t next = samples.hi.x - 1;
    Box3 layer = samples;
    layer.lo.x = next;
    const auto rows = local.sides_at(next);
    const Sides expected_rows = sides_of(whole, layer);
    for (std::size_t row = 0; row < expected_rows.size(); ++row)
      EXPECT_EQ(rows[row / 64] >> (row % 64) & 1, static_cast<std::uint64_t>(expected_rows[row]));
  });
  return counts;
}

TEST(LocalMesh, AnswersAsTheWhole) {
  TriangleMesh ball = testing::dented_ball({20, 21, 19}, 16, 5);
  const Counts counts = expect_same(ball, {{40, 43, 38}, {1, 1, 1}});
  EXPECT_GT(counts.reached, 20);
  EXPECT_GT(counts.inside, 0);
  EXPECT_GT(counts.outside, 20);
  expect_same(ball, {{40, 23, 53}, {1, 1.9, 0.7}});
  // Corners on samples and between them, degenerate triangles, both ways to wind.
  std::mt19937 random(5);
  for (const double grid : {1.0, 0.5}) {
    TriangleMesh nasty = ball;
    for (Vec3& v : nasty.vertices)
      for (int a = 0; a < 3; ++a) v[a] = std::round(v[a] / grid) * grid;
    for (auto& t : nasty.triangles)
      if (random() % 2 != 0) std::swap(t[0], t[1]);
    expect_same(nasty, {{40, 43, 38}, {1, 1, 1}});
  }
}

// Triangles far larger than a brick are in few of those that their boxes touch.
TEST(LocalMesh, LargeTriangles) {
  std::mt19937 random(2);
  for (int round = 0; round < 4; ++round) {
    TriangleMesh box = testing::box_mesh({-34, -28, -22}, {34, 28, 22});
    testing::turn(box, random);
    for (Vec3& v : box.vertices) v = v + Vec3{48, 48, 48};
    const Counts counts = expect_same(box, {{96, 96, 96}, {1, 1, 1}});
    EXPECT_LT(counts.reached, 96 * 96 * 96 / 512 / 2);
    EXPECT_GT(counts.inside, 3);
  }
  // Faces that go with the rows: on samples, and between them.
  for (const double at : {6.0, 6.5}) {
    const TriangleMesh flat = testing::box_mesh({at, at, at}, {at + 32, at + 32, at + 32});
    EXPECT_GT(expect_same(flat, {{48, 48, 48}, {1, 1, 1}}).inside, 3);
  }
}

// Of a lattice of any size: never says no where something is.
TEST(BlockSet, MeetsWhatWasAdded) {
  std::mt19937 random(6);
  for (const Index3 size : {Index3{30, 20, 10}, Index3{5000, 4000, 6000}, Index3{1 << 19, 9, 9}}) {
    BlockSet set(size);
    EXPECT_LT(set.bytes(), std::uint64_t{1} << 19);
    EXPECT_FALSE(set.meets({{}, size}));
    for (int round = 0; round < 50; ++round) {
      Box3 box;
      for (int a = 0; a < 3; ++a) {
        box.lo[a] = static_cast<std::int64_t>(random() % static_cast<std::uint64_t>(size[a]));
        box.hi[a] = box.lo[a] + 1 + static_cast<std::int64_t>(random() % 8);
      }
      set.add(box);
      EXPECT_TRUE(set.meets({box.lo, box.lo + splat(1)}));
      EXPECT_TRUE(set.meets({box.lo - splat(3), box.lo + splat(1)}));
    }
    EXPECT_TRUE(set.meets({{}, size}));
  }
  EXPECT_TRUE(BlockSet().meets({{}, {1, 1, 1}}));
}

}  // namespace
}  // namespace voxweld
