// Doubles whose differences overflow give the surface that the same samples give scaled down.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/support/contour_in_memory.h"
#include "tests/support/lattice_place.h"

namespace voxweld {
namespace {

using testing::MemoryVolume;

// A tilted ball, steep or not, in the range [-1, 1].
VolumeContour contour_of(double factor, double steepness, Gradient gradient) {
  const Index3 size{21, 20, 19};
  const MemoryVolume volume = MemoryVolume::made<double>(size, SampleType::f64, [=](Index3 s) {
    const Vec3 d = testing::as_vec3(s) - Vec3{9.7, 10.2, 9.1};
    return factor * std::clamp(steepness * (6.3 + 0.11 * d.x - 0.07 * d.y - std::sqrt(dot(d, d))),
                               -1.0, 1.0);
  });
  ContourParameters parameters;
  parameters.surface.isovalue = 0.125 * factor;
  parameters.surface.gradient = gradient;
  return contour_volume(volume, parameters);
}

void expect_same(const VolumeContour& expected, const VolumeContour& found) {
  ASSERT_EQ(expected.tiles.size(), found.tiles.size());
  for (std::size_t i = 0; i < expected.tiles.size(); ++i) {
    EXPECT_EQ(expected.tiles[i].positions, found.tiles[i].positions);
    EXPECT_EQ(expected.tiles[i].triangles, found.tiles[i].triangles);
  }
}

// A power of two changes no bit but those of the exponent.
TEST(HugeValues, DoublesUpToTheirLimitGiveTheSameSurface) {
  for (const Gradient gradient : {Gradient::eno, Gradient::central, Gradient::subcell})
    for (const double steepness : {0.1, 0.7, 5.0}) {
      const VolumeContour plain = contour_of(1, steepness, gradient);
      ASSERT_FALSE(plain.tiles.empty());
      for (const double factor : {0x1p1023, 0x1p1000, 0x1p600, 0x1p-600, 0x1p-900})
        expect_same(plain, contour_of(factor, steepness, gradient));
    }
}

// Where all samples are the same there is no slope, though their multiples are rounded.
TEST(HugeValues, TwoValuesGiveOneSurfaceWhateverTheyAre) {
  for (const Gradient gradient : {Gradient::eno, Gradient::central, Gradient::subcell}) {
    const VolumeContour plain = contour_of(1, 1e9, gradient);
    ASSERT_FALSE(plain.tiles.empty());
    for (const double factor : {0.1, 0.3, 1.0 / 3, 1e30, 1.7e308}) {
      SCOPED_TRACE(factor);
      const VolumeContour found = contour_of(factor, 1e9, gradient);
      ASSERT_EQ(plain.tiles.size(), found.tiles.size());
      for (std::size_t i = 0; i < plain.tiles.size(); ++i) {
        ASSERT_EQ(plain.tiles[i].positions.size(), found.tiles[i].positions.size());
        for (std::size_t v = 0; v < plain.tiles[i].positions.size(); ++v)
          for (std::size_t a = 0; a < 3; ++a)
            EXPECT_NEAR(plain.tiles[i].positions[v][a], found.tiles[i].positions[v][a], 2);
      }
    }
  }
}

// What is not a finite number has no say in crossings and normals beside it.
TEST(HugeValues, InfiniteSamplesAreFarInsideOrOutside) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const auto made = [&](double inside, double outside) {
    const MemoryVolume volume =
        MemoryVolume::made<double>(splat(12), SampleType::f64, [=](Index3 s) {
          const Vec3 d = testing::as_vec3(s) - Vec3{5.5, 5.5, 5.5};
          return dot(d, d) < 16 ? inside : outside;
        });
    ContourParameters parameters;
    parameters.surface.isovalue = 0;
    parameters.simplify.enabled = false;
    return contour_volume(volume, parameters);
  };
  const VolumeContour infinite = made(infinity, -infinity);
  ASSERT_FALSE(infinite.tiles.empty());
  // As many as there are between -1 and 1: signs are the same.
  EXPECT_EQ(infinite.tiles[0].triangles.size(), made(1, -1).tiles[0].triangles.size());
}

}  // namespace
}  // namespace voxweld
