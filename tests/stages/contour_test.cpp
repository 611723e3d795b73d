#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <tuple>

#include "tests/support/contour_in_memory.h"
#include "tests/support/lattice_place.h"
#include "tests/support/mesh_check.h"
#include "tests/support/reference_dual.h"
#include "tests/support/sign_grid.h"

namespace voxweld {
namespace {

using testing::MemoryVolume;
using testing::weld_tiles;

MemoryVolume sphere(int n, double radius) {
  const double c = (n - 1) / 2.0;
  return MemoryVolume::made<float>(splat(n), SampleType::f32, [=](Index3 s) {
    const Vec3 d = testing::as_vec3(s) - Vec3{c, c, c};
    return radius - std::sqrt(dot(d, d));
  });
}

MemoryVolume noise(Index3 size, unsigned seed) {
  std::mt19937 random(seed);
  return MemoryVolume::made<std::uint8_t>(size, SampleType::u8, [&](Index3) { return random(); });
}

ContourParameters parameters(double isovalue) {
  ContourParameters p;
  p.surface.isovalue = isovalue;
  return p;
}

testing::MeshSummary summary(const VolumeContour& contour) {
  return testing::summarize(weld_tiles(contour.tiles).triangles);
}

testing::SignGrid signs(const MemoryVolume& volume, double isovalue) {
  const std::span samples(reinterpret_cast<const std::uint8_t*>(volume.samples.data()),
                          volume.samples.size());
  return testing::signs_of<std::uint8_t>(
      volume.size, samples, [&](std::uint8_t v) { return testing::inside_above(v, isovalue); });
}

// A box with rounded corners, larger than several bricks: its flat sides collapse above them.
MemoryVolume block(int n) {
  return MemoryVolume::made<float>(splat(n), SampleType::f32, [=](Index3 s) {
    const Vec3 d = testing::as_vec3(s) - Vec3{n / 2.0, n / 2.0, n / 2.0};
    return n / 2.0 - 2.3 - std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)});
  });
}

using Corner = std::tuple<std::int64_t, std::int64_t, std::int64_t, int>;  // cell z y x, sheet
using Quad = std::array<Corner, 4>;

Quad rotated(Quad quad) {
  std::rotate(quad.begin(), std::min_element(quad.begin(), quad.end()), quad.end());
  return quad;
}

// The quads of an unsimplified mesh: two triangles (a, b, c) and (a, c, d) each.
std::vector<Quad> quads_of(const VolumeContour& contour) {
  std::vector<Quad> quads;
  for (const TileMesh& tile : contour.tiles)
    for (std::size_t i = 0; i + 1 < tile.triangles.size(); i += 2) {
      const auto corner = [&](std::uint32_t v) {
        const CellKey leaf = tile.ids[v].leaf();
        return Corner{leaf.at.z, leaf.at.y, leaf.at.x, tile.ids[v].sheet()};
      };
      const auto& first = tile.triangles[i];
      quads.push_back(rotated({corner(first[0]), corner(first[1]), corner(first[2]),
                               corner(tile.triangles[i + 1][2])}));
    }
  std::sort(quads.begin(), quads.end());
  return quads;
}

// Bricks of all sizes up to 2^largest cells give the same mesh, closed where its topology is kept.
// Returns what those of 2^4 give.
VolumeContour expect_one_mesh(const MemoryVolume& volume, const ContourParameters& p,
                              std::uint64_t tile_vertices = 500000, int largest = 6) {
  const VolumeContour first = contour_volume(volume, p, {4, tile_vertices, 0.01});
  const testing::LatticeWeld mesh = weld_tiles(first.tiles);
  if (p.simplify.topology == Topology::safe) {
    EXPECT_TRUE(summary(first).sound()) << summary(first);
  }
  for (int level = 5; level <= largest; ++level) {
    const auto other = weld_tiles(contour_volume(volume, p, {level, tile_vertices, 0.01}).tiles);
    EXPECT_EQ(other.vertices, mesh.vertices) << level;
    EXPECT_EQ(other.triangles, mesh.triangles) << level;
  }
  return first;
}

TEST(Contour, WithoutSimplificationItIsTheReferenceQuadForQuad) {
  for (unsigned seed = 0; seed < 6; ++seed) {
    const MemoryVolume volume = noise({17, 16, 19}, seed);
    ContourParameters p = parameters(100 + 20 * seed);
    p.simplify.enabled = false;
    const auto grid = signs(volume, p.surface.isovalue.value);
    const auto reference = testing::reference_dual(grid);
    std::vector<Quad> expected;
    for (const auto& quad : reference.quads) {
      Quad q;
      for (std::size_t k = 0; k < 4; ++k)
        q[k] = {quad[k].cell.z, quad[k].cell.y, quad[k].cell.x, quad[k].patch};
      expected.push_back(rotated(q));
    }
    std::sort(expected.begin(), expected.end());
    const auto contour = contour_volume(volume, p, {4, 500000, 0.01});
    EXPECT_EQ(quads_of(contour), expected) << seed;
    EXPECT_EQ(contour.counts.crossing_edges,
              static_cast<std::uint64_t>(testing::count_crossings(grid).total()));
    EXPECT_EQ(contour.counts.vertices, reference.vertices());
    EXPECT_TRUE(summary(contour).sound()) << summary(contour);
  }
}

TEST(Contour, EveryToleranceKeepsTheTopologyOfTheUniformMesh) {
  for (unsigned seed = 0; seed < 4; ++seed)
    for (const MemoryVolume& volume : {noise({18, 21, 16}, seed), sphere(30, 5 + 2 * seed)}) {
      ContourParameters p = parameters(volume.type == SampleType::u8 ? 128 : 0);
      p.simplify.enabled = false;
      const auto uniform = summary(contour_volume(volume, p, {5, 500000, 0.01}));
      EXPECT_TRUE(uniform.sound()) << uniform;
      p.simplify.enabled = true;
      for (const double tolerance : {0.01, 0.3, 2.0, 100.0}) {
        p.simplify.tolerance = tolerance;
        EXPECT_EQ(summary(contour_volume(volume, p, {4, 500000, 0.01})), uniform) << tolerance;
      }
    }
}

TEST(Contour, FlatRegionsCollapseAboveTheBricksTheSameAsInside) {
  const MemoryVolume volume = block(100);
  for (const QefForm form : {QefForm::qr, QefForm::normal}) {
    ContourParameters p = parameters(0);
    p.simplify.qef = form;
    const VolumeContour contour = expect_one_mesh(volume, p, 1024, 7);
    EXPECT_GT(contour.collapsed_above, 0u);
    EXPECT_FALSE(contour.top.empty());
  }
}

TEST(Contour, FreeTopologyHasBalancedEdgesForEveryBrickSize) {
  ContourParameters p = parameters(128);
  p.simplify.topology = Topology::free;
  p.simplify.tolerance = 1.5;
  for (unsigned seed = 0; seed < 3; ++seed) {
    const MemoryVolume volume = noise({40, 33, 20}, seed);
    const auto mesh = weld_tiles(expect_one_mesh(volume, p).tiles);
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> balance;
    for (const auto& t : mesh.triangles)
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t a = t[k], b = t[(k + 1) % 3];
        balance[{std::min(a, b), std::max(a, b)}] += a < b ? 1 : -1;
      }
    for (const auto& [edge, sum] : balance) EXPECT_EQ(sum, 0);
    EXPECT_FALSE(mesh.triangles.empty());
  }
}

TEST(Contour, ThinVolumesAndConstantOnesAreClosed) {
  for (const Index3 size : {Index3{1, 1, 1}, Index3{1, 1, 9}, Index3{2, 5, 1}, Index3{16, 16, 16},
                            Index3{15, 31, 1}, Index3{48, 1, 16}}) {
    SCOPED_TRACE(::testing::PrintToString(std::array{size.x, size.y, size.z}));
    const auto volume =
        MemoryVolume::made<std::uint8_t>(size, SampleType::u8, [](Index3) { return 200; });
    EXPECT_EQ(summary(expect_one_mesh(volume, parameters(128))).euler, 2);
  }
}

TEST(Contour, OpenBordersLackThePolygonsOfTheRingAlone) {
  const MemoryVolume volume = noise({20, 18, 17}, 9);
  ContourParameters p = parameters(128);
  p.simplify.enabled = false;
  const auto closed = quads_of(contour_volume(volume, p, {4, 500000, 0.01}));
  p.surface.border = Border::open;
  const auto open = quads_of(contour_volume(volume, p, {4, 500000, 0.01}));
  EXPECT_TRUE(std::includes(closed.begin(), closed.end(), open.begin(), open.end()));
  std::size_t inner = 0;
  const auto grid = signs(volume, 128);
  each_index({splat(1), volume.size + splat(1)}, [&](Index3 at) {
    for (int axis = 0; axis < 3; ++axis) {
      Index3 next = at;
      ++next[axis];
      if (next[axis] <= volume.size[axis] && grid.inside(at) != grid.inside(next)) ++inner;
    }
  });
  EXPECT_EQ(open.size(), inner);
}

TEST(Contour, SphereIsClosedForEveryBrickSize) {
  expect_one_mesh(sphere(40, 13.3), parameters(0));
}

TEST(Contour, NoiseIsClosedWithAndWithoutSimplification) {
  for (unsigned seed = 0; seed < 5; ++seed)
    for (const bool simplify : {false, true}) {
      ContourParameters p = parameters(128);
      p.simplify.enabled = simplify;
      p.simplify.tolerance = 0.5;
      SCOPED_TRACE(seed);
      expect_one_mesh(noise({19, 33, 17}, seed), p, 2000);
    }
}

}  // namespace
}  // namespace voxweld
