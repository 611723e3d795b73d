#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "tests/stages/cluster_volumes.h"
#include "tests/support/mesh_check.h"
#include "tests/support/random_volumes.h"

namespace voxweld {
namespace {

using testing::by_sheets;
using testing::MemoryVolume;

VolumeContour contour(const MemoryVolume& volume, const ContourParameters& parameters, int level,
                      std::uint64_t tile_vertices = 500000, double precision = 0.01) {
  return contour_volume(volume, parameters, {level, tile_vertices, precision});
}

testing::MeshSummary summary(const VolumeContour& contour) {
  return testing::summarize(testing::weld_tiles(contour.tiles).triangles);
}

struct Case {
  MemoryVolume volume;
  double tolerance = 0;
};
std::vector<Case> cases(unsigned seeds = 3) {
  std::vector<Case> all;
  for (unsigned seed = 0; seed < seeds; ++seed)
    for (const double tolerance : {0.1, 0.6, testing::infinite}) {
      all.push_back({testing::plates(61, seed), tolerance});
      all.push_back({testing::noise_volume(36, seed), tolerance});
    }
  return all;
}

TEST(ManifoldContour, IsTheSameForBricksOfAnySizeAndTiles) {
  for (const Case& c : cases()) {
    const VolumeContour first = contour(c.volume, by_sheets(c.tolerance), 4, 3000);
    const testing::LatticeWeld mesh = testing::weld_tiles(first.tiles);
    for (const int level : {5, 6}) {
      const VolumeContour other = contour(c.volume, by_sheets(c.tolerance), level, 3000);
      ASSERT_EQ(other.tiles.size(), first.tiles.size());
      for (std::size_t i = 0; i < first.tiles.size(); ++i) {
        EXPECT_EQ(other.tiles[i].positions, first.tiles[i].positions);
        EXPECT_EQ(other.tiles[i].ids, first.tiles[i].ids);
        EXPECT_EQ(other.tiles[i].normals, first.tiles[i].normals);
        EXPECT_EQ(other.tiles[i].triangles, first.tiles[i].triangles);
      }
      EXPECT_EQ(other.counts.by_level.leaves, first.counts.by_level.leaves);
      EXPECT_EQ(other.counts.vertices, first.counts.vertices);
      EXPECT_EQ(other.counts.by_level.errors, first.counts.by_level.errors);
    }
    // One tile has the same triangles as many.
    const auto whole = testing::weld_tiles(contour(c.volume, by_sheets(c.tolerance), 5).tiles);
    EXPECT_EQ(whole.vertices.size(), mesh.vertices.size());
    EXPECT_EQ(whole.triangles.size(), mesh.triangles.size());
  }
}

// Where there are few lattice points, vertices of one node want the same ones. What a vertex above has
// taken in wants none.
TEST(ManifoldContour, IsTheSameForBricksOfAnySizeOnACoarseLattice) {
  for (const Case& c : cases()) {
    const auto mesh = [&](int level) {
      return contour(c.volume, by_sheets(c.tolerance), level, 500000, 0.25).tiles.at(0);
    };
    const TileMesh first = mesh(4);
    for (const int level : {5, 6}) {
      const TileMesh other = mesh(level);
      EXPECT_EQ(other.ids, first.ids);
      EXPECT_EQ(other.positions, first.positions);
    }
  }
}

TEST(ManifoldContour, KeepsTheTopologyOfTheUnsimplifiedMesh) {
  for (const Case& c : cases(testing::volumes_to_try(3))) {
    ContourParameters parameters = by_sheets(c.tolerance);
    parameters.simplify.enabled = false;
    const testing::MeshSummary fine = summary(contour(c.volume, parameters, 5));
    EXPECT_TRUE(fine.sound());
    EXPECT_EQ(summary(contour(c.volume, by_sheets(c.tolerance), 5)), fine);
  }
}

// Where hardly any node may go on, what it holds stays as it is, in bricks and above them.
TEST(ManifoldContour, NodesThatAreSealedEarlyKeepWhatTheyHold) {
  std::uint64_t more = 0;
  for (const Case& c : cases()) {
    if (c.tolerance < 0.5) continue;
    ContourParameters sealed = by_sheets(c.tolerance), fine = sealed;
    sealed.simplify.sealing = {2, 8, 2};
    fine.simplify.enabled = false;
    const VolumeContour first = contour(c.volume, sealed, 4);
    EXPECT_EQ(summary(first), summary(contour(c.volume, fine, 5)));
    const VolumeContour usual = contour(c.volume, by_sheets(c.tolerance), 5);
    EXPECT_GE(first.counts.vertices, usual.counts.vertices);
    more += first.counts.vertices - usual.counts.vertices;
    const VolumeContour other = contour(c.volume, sealed, 6);
    EXPECT_EQ(other.tiles.at(0).positions, first.tiles.at(0).positions);
    EXPECT_EQ(other.tiles.at(0).triangles, first.tiles.at(0).triangles);
    EXPECT_EQ(other.counts.by_level.leaves, first.counts.by_level.leaves);
  }
  EXPECT_GT(more, 1000u);
}

// What merge knows to be above the bricks are vertices of the mesh, and nothing that a larger one has
// taken in.
TEST(ManifoldContour, EachVertexAboveBricksIsOfTheMesh) {
  for (const Case& c : cases()) {
    const AboveBricks above = contour(c.volume, by_sheets(c.tolerance), 4).above;
    std::vector<bool> linked(above.leaves.size());
    for (const std::uint32_t link : above.links)
      if (link != no_cluster) linked.at(link) = true;
    EXPECT_EQ(std::count(linked.begin(), linked.end(), false), 0) << c.tolerance;
  }
}

// Vertices of nodes in one another have lattice points of their own.
TEST(ManifoldContour, NoTwoVerticesAreAtOnePlace) {
  for (const double precision : {0.01, 0.25})
    for (const Case& c : cases()) {
      const VolumeContour all =
          contour_volume(c.volume, by_sheets(c.tolerance), {5, 500000, precision});
      std::set<VertexId> ids;
      std::set<LatticePoint> places;
      for (const TileMesh& tile : all.tiles) {
        ids.insert(tile.ids.begin(), tile.ids.end());
        places.insert(tile.positions.begin(), tile.positions.end());
      }
      EXPECT_EQ(places.size(), ids.size());
      EXPECT_EQ(ids.size(), all.counts.vertices);
    }
}

// Slabs that bricks of 16 cells cut into many pieces. One is thinner than two cells: along its rim
// its two sides are one cluster, which crosses edges twice and stays as it is; within they are two.
TEST(ManifoldContour, FlatThingsCollapseAboveBricks) {
  struct Slab {
    double half = 0;  // of its thickness
    std::uint64_t vertices = 0;
  };
  for (const Slab& wanted : {Slab{0.6, 2000}, Slab{6.0, 400}}) {
    const double half = wanted.half;
    const MemoryVolume slab = MemoryVolume::made<float>(splat(140), SampleType::f32, [&](Index3 s) {
      const auto off = [](std::int64_t v, double middle) {
        return std::abs(static_cast<double>(v) - middle);
      };
      return static_cast<float>(
          std::min({half - off(s.z, 69.8), 65.3 - off(s.x, 69.7), 65.3 - off(s.y, 69.6)}));
    });
    const VolumeContour all = contour(slab, by_sheets(0.5), 4);
    EXPECT_FALSE(all.above.leaves.empty());
    EXPECT_LT(all.counts.vertices, wanted.vertices) << half;
    ContourParameters safe = by_sheets(0.5);
    safe.simplify.topology = Topology::safe;
    EXPECT_LT(2 * all.counts.vertices, contour(slab, safe, 4).counts.vertices) << half;
    EXPECT_EQ(summary(all).euler, 2);
  }
}

}  // namespace
}  // namespace voxweld
