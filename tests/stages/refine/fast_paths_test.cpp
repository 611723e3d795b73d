// What is quick against what is plain.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>

#include "random_places.h"
#include "stages/refine/edge_queue.h"
#include "stages/refine/edit_moves.h"
#include "stages/refine/nearest_triangle.h"
#include "stages/refine/refine_range.h"
#include "stages/refine/triangle_grid.h"
#include "stages/refine/vertex_cubes.h"
#include "storage/types/index_table.h"
#include "torus.h"

namespace voxweld {
namespace {

using testing::RandomPlaces;

LatticeBox random_box(RandomPlaces& random, const LatticeBox& around, std::int32_t beyond) {
  LatticeTriangle corners;
  for (LatticePoint& p : corners)
    for (std::size_t a = 0; a < 3; ++a) p[a] = random(around.lo[a] - beyond, around.hi[a] + beyond);
  // Most are small.
  if (random(0, 3) != 0)
    for (std::size_t k = 1; k < 3; ++k)
      for (std::size_t a = 0; a < 3; ++a) corners[k][a] = corners[0][a] + random(-40, 40);
  return LatticeBox::around(corners);
}

// Cubes of few steps and of so many that their coordinates are rounded; boxes that lie far outside.
TEST(TriangleGrid, FindsAllThatMeet) {
  RandomPlaces random;
  for (const std::int32_t side : {300, 20000, 20001, 3000000}) {
    const LatticeBox around{{500, 600, 700}, {500 + side, 600 + side, 700 + side}};
    TriangleGrid grid(around, side == 20000 ? 100 : 100000);  // both make bins of their own sizes
    std::vector<LatticeBox> boxes(600);
    for (std::uint32_t t = 0; t < boxes.size(); ++t) grid.put(t, random_box(random, around, side));
    for (std::uint32_t t = 0; t < boxes.size(); ++t)  // they change, and some go
      grid.put(t, boxes[t] = random_box(random, around, side * 2 / 3));
    std::vector<bool> there(boxes.size(), true);
    for (std::uint32_t t = 0; t < boxes.size(); t += 5) {
      grid.remove(t);
      there[t] = false;
    }
    for (std::uint32_t a = 0; a < boxes.size(); ++a) {
      BoxQueries some = grid.queries();
      for (std::uint32_t k = a; k < std::min<std::size_t>(a + 11, boxes.size()); ++k)
        some.add(boxes[k]);
      std::vector<std::uint64_t> met(boxes.size());
      EXPECT_TRUE(grid.none_near(some, [&](std::uint32_t t, std::uint64_t bits) {
        met[t] = bits;
        return false;
      }));
      std::vector<bool> found(boxes.size());
      grid.each_near(boxes[a], [&](std::uint32_t t) {
        EXPECT_TRUE(there[t] && !found[t]);
        found[t] = true;
      });
      for (std::uint32_t b = 0; b < boxes.size(); ++b) {
        if (!there[b]) continue;
        EXPECT_TRUE(found[b] || !boxes[a].meets(boxes[b]));
        for (std::uint32_t k = a; k < std::min<std::size_t>(a + 11, boxes.size()); ++k)
          EXPECT_TRUE((met[b] >> (k - a) & 1) != 0 || !boxes[k].meets(boxes[b]));
      }
    }
  }
}

TEST(TriangleGrid, PassesOverWhatIsFarAway) {
  const LatticeBox around{{0, 0, 0}, {16000, 16000, 16000}};
  TriangleGrid grid(around, 100);
  grid.put(0, {{10, 10, 10}, {20, 20, 20}});
  grid.put(1, {{22, 10, 10}, {40, 20, 20}});
  std::vector<std::uint32_t> found;
  grid.each_near({{5, 5, 5}, {21, 30, 30}}, [&](std::uint32_t t) { found.push_back(t); });
  EXPECT_EQ(found, std::vector<std::uint32_t>{0});
}

// Ids of neighbours, as meshes have them, and of any bits, 0 among them.
TEST(VertexTable, FindsThoseThatCameFirst) {
  RandomPlaces random;
  for (const std::size_t reserved : {0u, 700u, 5000u}) {
    std::vector<VertexId> ids;
    VertexTable table{VertexIdHash{&ids}};
    table.reserve(reserved);
    const auto find_or_add = [&](VertexId id) {
      const std::uint64_t hash = mix_bits(id.bits);
      const auto found = table.find(hash, [&](std::uint32_t i) { return ids[i] == id; });
      if (found != VertexTable::none) return found;
      ids.push_back(id);
      const auto next = static_cast<std::uint32_t>(ids.size() - 1);
      table.insert(hash, next);
      return next;
    };
    std::map<VertexId, std::uint32_t> plain;
    for (std::uint32_t i = 0; i < 4000; ++i) {
      const auto few = static_cast<std::uint64_t>(random(0, 1500));
      const VertexId id =
          i % 2 == 0 ? VertexId::make(0, few, 0) : VertexId{few * 0x0123456789abcdefu};
      const auto next = static_cast<std::uint32_t>(plain.size());
      ASSERT_EQ(find_or_add(id), plain.try_emplace(id, next).first->second);
    }
    table.clear();
    EXPECT_EQ(table.find(mix_bits(0), [](std::uint32_t) { return true; }), VertexTable::none);
  }
}

TEST(VertexCubes, AreThoseOfCornersAndBoxes) {
  const RefineMesh mesh = testing::torus();
  for (int pass = 0; pass < refine_passes; ++pass) {
    const CubeLattice cubes(testing::torus_frame(), pass);
    const VertexCubes places(mesh, cubes);
    std::size_t inside = 0;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      const LatticeBox box = mesh.box(t);
      const Box3 around = places.around(t);
      EXPECT_EQ(places.home(t), home_of(mesh, t, cubes));
      EXPECT_EQ(around.lo, cubes.cube_of(box.lo));
      EXPECT_EQ(around.hi, cubes.cube_of(box.hi) + splat(1));
      EXPECT_EQ(places.is_inside(t), cubes.cube_of(box.lo) == cubes.cube_of(box.hi));
      inside += places.is_inside(t) ? 1 : 0;
    }
    EXPECT_GT(inside, 0u);
    EXPECT_LT(inside, mesh.triangles.size());
  }
}

TEST(EdgeQueue, GivesTheCheapestFirstAndEqualOnesInTurn) {
  RandomPlaces random;
  EdgeQueue queue;
  std::vector<double> costs;
  QueuedEdge edge{};
  for (std::uint32_t i = 0; i < 3000; ++i) {
    costs.push_back(std::ldexp(random(0, 1000), random(-30, 30)));
    queue.push(costs.back(), {i, 0, 0, 0});
    if (i % 3 == 0) {
      ASSERT_TRUE(queue.pop(edge));
      costs[edge.u] = -1;
    }
  }
  double last = 0;
  while (queue.pop(edge)) {
    EXPECT_GE(costs[edge.u] * 17 / 16 + 0x1p-39, last);
    last = std::max(last, costs[edge.u]);
    costs[edge.u] = -1;
  }
  EXPECT_EQ(std::ranges::count(costs, -1.0), 3000) << "each came out once";
  for (std::uint32_t i = 0; i < 5; ++i) queue.push(2.5, {i, 0, 0, 0});
  for (std::uint32_t i = 0; i < 5; ++i) {
    ASSERT_TRUE(queue.pop(edge));
    EXPECT_EQ(edge.u, i);
  }
  EXPECT_FALSE(queue.pop(edge));
}

// Whether a change makes triangles intersect is known from shadows and from what was known before;
// hits() looks at all pairs. Half of the changes are made, so that what is kept has to be right.
TEST(EditMesh, AChangeIsCleanWhereNothingIsHit) {
  RandomPlaces random;
  const LatticeBox box{{0, 0, 0}, {1000, 1000, 1000}};
  EditMesh mesh(testing::torus(), box);
  mesh.set_intersecting(mesh.find_intersecting());
  EditMoves moves(mesh);
  Change change;
  std::size_t clean = 0, unclean = 0;
  const auto look = [&](const EditMesh::Step& step) {
    const bool is_clean = mesh.clean(change);
    ASSERT_EQ(is_clean, mesh.hits(change, 1) == 0);
    ++(is_clean ? clean : unclean);
    if (random(0, 1) == 0 || !mesh.keeps_samples(change, step, 1e9)) return;
    mesh.apply(change, step);
  };
  for (int round = 0; round < 6000; ++round) {
    const auto t = static_cast<std::uint32_t>(random(0, static_cast<int>(mesh.triangles()) - 1));
    if (!mesh.alive(t)) continue;
    const std::uint32_t u = mesh.corners(t)[0], v = mesh.corners(t)[1];
    LatticePoint at = mesh.position(u);
    for (std::int32_t& x : at) x += random(-60, 60);
    if (round % 3 == 0) {
      if (mesh.freedom(u) == Freedom::free && moves.move(u, at, change))
        look({u, at, EditMesh::none});
    } else if (round % 3 == 1) {
      if (mesh.movable(t) && moves.flip(t, 1, change)) look({});
    } else if (round % 15 == 2) {
      const auto ends = moves.ends(u, v);
      if (!ends || !moves.linked(ends->gone, ends->keep)) continue;
      if (ends->stays) at = mesh.position(ends->keep);
      if (moves.collapse(ends->gone, ends->keep, at, change)) look({ends->keep, at, ends->gone});
    }
  }
  EXPECT_GT(clean, 300u);
  EXPECT_GT(unclean, 300u);
}

// By the exact test of all pairs.
std::vector<std::uint32_t> triangles_that_intersect(const EditMesh& mesh) {
  std::vector<std::uint32_t> found;
  for (std::uint32_t t = 0; t < mesh.triangles(); ++t) {
    bool any = false;
    for (std::uint32_t other = 0; other < mesh.triangles() && !any; ++other)
      any = t != other && mesh.alive(t) && mesh.alive(other) &&
            intersect_beyond_shared(mesh.shape(t), mesh.shape(other));
    if (any) found.push_back(t);
  }
  return found;
}

// Of many changes that are only asked what lies around them, the end tells the rest: what a look at all
// triangles finds.
TEST(EditMesh, ManyChangesTellInTheEndWhatIntersects) {
  for (std::int32_t reach : {30, 120, 400}) {
    RandomPlaces random;
    EditMesh mesh(testing::torus(), {{0, 0, 0}, {1000, 1000, 1000}});
    ASSERT_TRUE(mesh.find_intersecting().empty());
    EditMoves moves(mesh);
    Change change;
    mesh.begin_changes();
    std::size_t gone = 0;
    for (int round = 0; round < 400; ++round) {
      const auto t = static_cast<std::uint32_t>(random(0, static_cast<int>(mesh.triangles()) - 1));
      if (!mesh.alive(t)) continue;
      const auto ends = moves.ends(mesh.corners(t)[0], mesh.corners(t)[1]);
      if (!ends || !moves.linked(ends->gone, ends->keep)) continue;
      LatticePoint at = mesh.position(ends->keep);
      if (!ends->stays)
        for (std::int32_t& x : at) x = std::clamp(x + random(-reach, reach), 0, 1000);
      const EditMesh::Step step{ends->keep, at, ends->gone};
      if (!moves.collapse(ends->gone, ends->keep, at, change) || !mesh.clean_around(change) ||
          !mesh.keeps_samples(change, step, 1e9))
        continue;
      mesh.apply(change, step);
      ++gone;
    }
    const std::vector<std::uint32_t> found = mesh.end_changes();
    EXPECT_EQ(found, triangles_that_intersect(mesh)) << reach;
    EXPECT_EQ(found, mesh.find_intersecting()) << reach;
    EXPECT_GT(gone, 20u) << reach;
    EXPECT_EQ(found.empty(), reach == 30) << reach;
  }
}

}  // namespace
}  // namespace voxweld
