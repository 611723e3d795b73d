// One complex of several labels: balanced edges, the topology of the uniform mesh at any tolerance,
// the same whatever the bricks, and of two labels what one label alone gives.
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "tests/support/label_cases.h"
#include "tests/support/label_complex.h"

namespace voxweld {
namespace {

using testing::Complex;
using testing::distance2;
using testing::labels;
using testing::MemoryVolume;
using testing::noise;
using testing::shared_labels;
using testing::topology;
using testing::unbalanced;
using testing::voronoi;

Complex complex_of(const VolumeContour& contour) {
  Complex complex{testing::weld_tiles(contour.tiles), {}};
  for (const TileMesh& tile : contour.tiles) {
    EXPECT_EQ(tile.triangle_pairs.size(), tile.triangles.size());
    EXPECT_TRUE(std::is_sorted(tile.pairs.begin(), tile.pairs.end()));
    for (const std::uint32_t pair : tile.triangle_pairs) complex.pairs.push_back(tile.pairs[pair]);
  }
  return complex;
}

TEST(SharedLabels, EachLabelsEdgesBalanceInNoise) {
  for (unsigned seed = 0; seed < 3; ++seed)
    for (const unsigned count : {2u, 3u, 4u, 9u, seed == 0 ? 1000u : 25u})
      for (const double tolerance : {0.0, 0.3, 100.0}) {
        const MemoryVolume volume = noise({18, 19, 17}, count, seed);
        const Complex complex =
            complex_of(contour_volume(volume, shared_labels(tolerance), {4, 500000, 0.01}));
        EXPECT_GT(complex.mesh.triangles.size(), 1000u);
        EXPECT_EQ(unbalanced(complex), 0u) << count << " labels, tolerance " << tolerance;
      }
}

TEST(SharedLabels, EveryToleranceKeepsTheTopologyOfTheUniformMesh) {
  for (unsigned seed = 0; seed < 6; ++seed) {
    const MemoryVolume volume = voronoi(40, 14, 9, seed);
    const auto uniform_contour = contour_volume(volume, shared_labels(0), {4, 500000, 0.01});
    const Complex uniform = complex_of(uniform_contour);
    EXPECT_EQ(unbalanced(uniform), 0u);
    std::size_t before = uniform.mesh.vertices.size();
    for (const double tolerance : {0.05, 0.3, 2.0, 100.0}) {
      const Complex simplified =
          complex_of(contour_volume(volume, shared_labels(tolerance), {4, 500000, 0.01}));
      EXPECT_EQ(unbalanced(simplified), 0u) << tolerance;
      EXPECT_EQ(topology(simplified), topology(uniform)) << seed << ", " << tolerance;
      EXPECT_LE(simplified.mesh.vertices.size(), before);
      before = simplified.mesh.vertices.size();
    }
    EXPECT_LT(before * 3, uniform.mesh.vertices.size()) << "junctions collapse too";
  }
}

TEST(SharedLabels, DoNotDependOnTheBricks) {
  for (const MemoryVolume& volume : {voronoi(70, 20, 12, 5), noise({40, 35, 33}, 3, 1)}) {
    std::vector<TileMesh> first;
    for (const int level : {4, 5, 6, 7}) {
      const VolumeContour contour = contour_volume(volume, shared_labels(0.3), {level, 2048, 0.01});
      if (first.empty()) first = contour.tiles;
      SCOPED_TRACE(level);
      EXPECT_GT(first.size(), 1u);
      testing::expect_same_tiles(contour.tiles, first);
    }
  }
}

TEST(SharedLabels, OfOneLabelAndNothingElseAreThatLabelsOwnMesh) {
  const MemoryVolume volume = voronoi(50, 1, 1, 3);
  ContourParameters alone;
  alone.surface.label = 1;
  const VolumeContour one = contour_volume(volume, alone, {4, 1024, 0.01}),
                      both = contour_volume(volume, shared_labels(0.1), {4, 1024, 0.01});
  ASSERT_EQ(one.tiles.size(), both.tiles.size());
  for (std::size_t t = 0; t < one.tiles.size(); ++t) {
    EXPECT_EQ(one.tiles[t].positions, both.tiles[t].positions);
    EXPECT_EQ(one.tiles[t].normals, both.tiles[t].normals);
    EXPECT_EQ(one.tiles[t].triangles, both.tiles[t].triangles);
    EXPECT_EQ(both.tiles[t].pairs, (std::vector<MaterialPair>{{1, exterior}}));
  }
}

// Distances, in cells, of the vertices between 2, 3 and 4 of the cells of a Voronoi diagram to the
// plane, line or point where all of those are equally near.
struct JunctionErrors {
  std::array<double, 5> squares{}, largest{};
  std::array<std::size_t, 5> count{};
  void add(std::size_t labels, double distance) {
    squares[labels] += distance * distance;
    largest[labels] = std::max(largest[labels], distance);
    ++count[labels];
  }
  double rms(std::size_t labels) const {
    return std::sqrt(squares[labels] / static_cast<double>(count[labels]));
  }
};

// The nearest point to p at the same distance from all sites: p minus its least-norm correction.
double distance_to_junction(const Vec3& p, const std::vector<Vec3>& sites) {
  // Orthonormalise the differences to the first site; each gives one coordinate of the correction.
  std::vector<Vec3> basis;
  std::vector<double> offset;
  for (std::size_t i = 1; i < sites.size(); ++i) {
    Vec3 n = sites[i] - sites[0];
    double d = (dot(sites[i], sites[i]) - dot(sites[0], sites[0])) / 2 - dot(n, p);
    for (std::size_t k = 0; k < basis.size(); ++k) {
      const double along = dot(n, basis[k]);
      n = n - basis[k] * along;
      d -= along * offset[k];
    }
    const double length = std::sqrt(dot(n, n));
    basis.push_back(n * (1 / length));
    offset.push_back(d / length);
  }
  double sum = 0;
  for (const double d : offset) sum += d * d;
  return std::sqrt(sum);
}

JunctionErrors junction_errors(double tolerance) {
  const std::vector<Vec3> sites = {
      {20.3, 21.1, 23.7}, {43.9, 25.2, 20.4}, {30.1, 45.3, 27.9}, {33.3, 28.8, 46.2}};
  const Vec3 middle{31.6, 31.4, 31.7};
  const MemoryVolume volume = labels(splat(64), [&](Index3 p) -> std::uint64_t {
    if (distance2(p, middle) > 27 * 27) return 0;
    std::size_t best = 0;
    for (std::size_t i = 1; i < 4; ++i)
      if (distance2(p, sites[i]) < distance2(p, sites[best])) best = i;
    return 1 + best;
  });
  const VolumeContour contour = contour_volume(volume, shared_labels(tolerance), {6, 500000, 0.01});
  const Complex complex = complex_of(contour);
  EXPECT_EQ(contour.tiles.size(), 1u);
  std::vector<std::set<Material>> around(complex.mesh.vertices.size());
  for (std::size_t i = 0; i < complex.pairs.size(); ++i)
    for (const std::uint32_t v : complex.mesh.triangles[i]) {
      around[v].insert(complex.pairs[i].inside);
      around[v].insert(complex.pairs[i].outside);
    }
  JunctionErrors errors;
  for (std::size_t v = 0; v < around.size(); ++v) {
    if (around[v].contains(exterior)) continue;
    std::vector<Vec3> of;
    for (const Material label : around[v]) of.push_back(sites[label - 1]);
    const Vec3 p = testing::place_of(contour.tiles[0].lattice, complex.mesh.vertices[v]);
    errors.add(of.size(), distance_to_junction(p, of));
  }
  return errors;
}

TEST(SharedLabels, JunctionVerticesSitOnTheJunction) {
  for (const double tolerance : {0.0, 0.1, 0.3}) {
    const JunctionErrors e = junction_errors(tolerance);
    // Voxels tell where a surface is to a fraction of a cell, and where three meet to some more.
    EXPECT_LT(e.rms(2), 0.1) << tolerance;
    EXPECT_LT(e.rms(3), 0.16) << tolerance;
    EXPECT_LT(e.largest[2], 0.3) << tolerance;
    EXPECT_LT(e.largest[3], 0.35) << tolerance;
    EXPECT_EQ(e.count[4], 1u) << tolerance;
    EXPECT_LT(e.largest[4], 0.35) << tolerance;
  }
}

TEST(SharedLabels, SixtyFourBitLabelsStayApart) {
  const std::uint64_t high = 0xfffffffffffffffeu;
  const MemoryVolume volume = labels({20, 20, 20}, [&](Index3 p) {
    return p.x < 7 ? high : p.x < 13 ? high - 1 : std::uint64_t{1} << 53;
  });
  const Complex complex = complex_of(contour_volume(volume, shared_labels(0.1), {4, 500000, 0.01}));
  std::set<MaterialPair> pairs(complex.pairs.begin(), complex.pairs.end());
  EXPECT_EQ(pairs, (std::set<MaterialPair>{{high - 1, high},
                                           {std::uint64_t{1} << 53, high - 1},
                                           {high, exterior},
                                           {high - 1, exterior},
                                           {std::uint64_t{1} << 53, exterior}}));
}

}  // namespace
}  // namespace voxweld
