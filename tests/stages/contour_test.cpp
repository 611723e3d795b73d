#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <random>

#include "tests/support/contour_in_memory.h"

namespace voxweld {
namespace {

using testing::contour_in_memory;
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

bool closed(const testing::WeldedMesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  for (const auto& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) ++edges[{t[k], t[(k + 1) % 3]}];
  for (const auto& [edge, count] : edges)
    if (count != 1 || edges.find({edge.second, edge.first}) == edges.end()) return false;
  return !edges.empty();
}

ContourParameters parameters(double isovalue) {
  ContourParameters p;
  p.surface.isovalue = isovalue;
  return p;
}

TEST(Contour, SphereIsClosedForEveryBrickSize) {
  const MemoryVolume volume = sphere(40, 13.3);
  testing::WeldedMesh first;
  for (const int level : {4, 5, 6}) {
    const auto contour = contour_in_memory(volume, parameters(0), {level, 500000, 0.01});
    const auto mesh = weld_tiles(contour.tiles);
    EXPECT_TRUE(closed(mesh)) << level;
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
      testing::WeldedMesh first;
      for (const int level : {4, 5, 6}) {
        const auto contour = contour_in_memory(volume, p, {level, 2000, 0.01});
        const auto mesh = weld_tiles(contour.tiles);
        EXPECT_TRUE(closed(mesh)) << seed << simplify << level;
        if (level == 4) first = mesh;
        EXPECT_EQ(mesh.triangles, first.triangles) << level;
        EXPECT_EQ(mesh.vertices, first.vertices) << level;
      }
    }
}

}  // namespace
}  // namespace voxweld
