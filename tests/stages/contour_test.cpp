#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <tuple>

#include "tests/support/contour_in_memory.h"
#include "tests/support/mesh_check.h"
#include "tests/support/reference_dual.h"
#include "tests/support/sign_grid.h"

namespace voxweld {
namespace {

using testing::MemoryVolume;
using testing::weld_tiles;

MemoryVolume sphere(int n, double radius) {
  std::vector<float> v;
  const double c = (n - 1) / 2.0;
  for (int z = 0; z < n; ++z)
    for (int y = 0; y < n; ++y)
      for (int x = 0; x < n; ++x)
        v.push_back(static_cast<float>(
            radius - std::sqrt((x - c) * (x - c) + (y - c) * (y - c) + (z - c) * (z - c))));
  return MemoryVolume::of<float>({n, n, n}, v, SampleType::f32);
}

MemoryVolume noise(Index3 size, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<std::uint8_t> v(static_cast<std::size_t>(size.x * size.y * size.z));
  for (auto& s : v) s = static_cast<std::uint8_t>(random());
  return MemoryVolume::of<std::uint8_t>(size, v, SampleType::u8);
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
  std::vector<float> v;
  for (int z = 0; z < n; ++z)
    for (int y = 0; y < n; ++y)
      for (int x = 0; x < n; ++x) {
        const double a =
            std::max({std::abs(x - n / 2.0), std::abs(y - n / 2.0), std::abs(z - n / 2.0)});
        v.push_back(static_cast<float>(n / 2.0 - 2.3 - a));
      }
  return MemoryVolume::of<float>({n, n, n}, v, SampleType::f32);
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

TEST(Contour, WithoutSimplificationItIsTheReferenceQuadForQuad) {
  for (unsigned seed = 0; seed < 6; ++seed) {
    const MemoryVolume volume = noise({17, 16, 19}, seed);
    ContourParameters p = parameters(100 + 20 * seed);
    p.simplify.enabled = false;
    const auto grid = signs(volume, p.surface.isovalue);
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
    testing::LatticeWeld first;
    for (const int level : {4, 5, 6, 7}) {
      const auto contour = contour_volume(volume, p, {level, 1024, 0.01});
      const auto mesh = weld_tiles(contour.tiles);
      if (level == 4) {
        first = mesh;
        EXPECT_GT(contour.collapsed_above, 0u);
        EXPECT_FALSE(contour.top.empty());
        EXPECT_TRUE(summary(contour).sound());
      }
      EXPECT_EQ(mesh.vertices, first.vertices) << level;
      EXPECT_EQ(mesh.triangles, first.triangles) << level;
    }
  }
}

TEST(Contour, FreeTopologyHasBalancedEdgesForEveryBrickSize) {
  ContourParameters p = parameters(128);
  p.simplify.topology = Topology::free;
  p.simplify.tolerance = 1.5;
  for (unsigned seed = 0; seed < 3; ++seed) {
    const MemoryVolume volume = noise({40, 33, 20}, seed);
    testing::LatticeWeld first;
    for (const int level : {4, 5, 6}) {
      const auto mesh = weld_tiles(contour_volume(volume, p, {level, 500000, 0.01}).tiles);
      std::map<std::pair<std::uint32_t, std::uint32_t>, int> balance;
      for (const auto& t : mesh.triangles)
        for (std::size_t k = 0; k < 3; ++k) {
          const std::uint32_t a = t[k], b = t[(k + 1) % 3];
          balance[{std::min(a, b), std::max(a, b)}] += a < b ? 1 : -1;
        }
      for (const auto& [edge, sum] : balance) EXPECT_EQ(sum, 0);
      if (level == 4) first = mesh;
      EXPECT_EQ(mesh.triangles, first.triangles) << level;
      EXPECT_FALSE(mesh.triangles.empty());
    }
  }
}

TEST(Contour, ThinVolumesAndConstantOnesAreClosed) {
  for (const Index3 size : {Index3{1, 1, 1}, Index3{1, 1, 9}, Index3{2, 5, 1}, Index3{16, 16, 16},
                            Index3{15, 31, 1}, Index3{48, 1, 16}}) {
    const MemoryVolume volume = MemoryVolume::of<std::uint8_t>(
        size, std::vector<std::uint8_t>(static_cast<std::size_t>(size.x * size.y * size.z), 200),
        SampleType::u8);
    testing::LatticeWeld first;
    for (const int level : {4, 5, 6}) {
      const auto contour = contour_volume(volume, parameters(128), {level, 500000, 0.01});
      EXPECT_TRUE(summary(contour).sound()) << size.x << " " << size.y << " " << size.z;
      EXPECT_EQ(summary(contour).euler, 2);
      const auto mesh = weld_tiles(contour.tiles);
      if (level == 4) first = mesh;
      EXPECT_EQ(mesh.triangles, first.triangles);
      EXPECT_EQ(mesh.vertices, first.vertices);
    }
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
  for (std::int64_t z = 1; z <= volume.size.z; ++z)
    for (std::int64_t y = 1; y <= volume.size.y; ++y)
      for (std::int64_t x = 1; x <= volume.size.x; ++x)
        for (int axis = 0; axis < 3; ++axis) {
          Index3 next{x, y, z};
          ++next[axis];
          if (next[axis] <= volume.size[axis] && grid.inside({x, y, z}) != grid.inside(next))
            ++inner;
        }
  EXPECT_EQ(open.size(), inner);
}

TEST(Contour, SphereIsClosedForEveryBrickSize) {
  const MemoryVolume volume = sphere(40, 13.3);
  testing::LatticeWeld first;
  for (const int level : {4, 5, 6}) {
    const auto contour = contour_volume(volume, parameters(0), {level, 500000, 0.01});
    const auto mesh = weld_tiles(contour.tiles);
    EXPECT_TRUE(summary(contour).sound()) << level;
    if (level == 4) first = mesh;
    EXPECT_EQ(mesh.vertices, first.vertices) << level;
    EXPECT_EQ(mesh.triangles, first.triangles) << level;
  }
}

TEST(Contour, NoiseIsClosedWithAndWithoutSimplification) {
  for (unsigned seed = 0; seed < 5; ++seed)
    for (const bool simplify : {false, true}) {
      ContourParameters p = parameters(128);
      p.simplify.enabled = simplify;
      p.simplify.tolerance = 0.5;
      const MemoryVolume volume = noise({19, 33, 17}, seed);
      testing::LatticeWeld first;
      for (const int level : {4, 5, 6}) {
        const auto contour = contour_volume(volume, p, {level, 2000, 0.01});
        const auto mesh = weld_tiles(contour.tiles);
        EXPECT_TRUE(summary(contour).sound()) << seed << simplify << level;
        if (level == 4) first = mesh;
        EXPECT_EQ(mesh.triangles, first.triangles) << level;
        EXPECT_EQ(mesh.vertices, first.vertices) << level;
      }
    }
}

}  // namespace
}  // namespace voxweld
