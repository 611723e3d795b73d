// Edges eight at a time against the estimator that makes one at a time.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <random>

#include "stages/build/edge_estimator.h"
#include "stages/build/edge_kernels.h"
#include "stages/build/hermite.h"
#include "tests/stages/with_all_kernels.h"
#include "tests/support/contour_in_memory.h"

namespace voxweld {
namespace {

using testing::MemoryVolume;
using testing::with_all_kernels;

std::array<std::uint32_t, 4> bits_of(const HermiteEdge& edge) {
  return {std::bit_cast<std::uint32_t>(edge.t), std::bit_cast<std::uint32_t>(edge.normal[0]),
          std::bit_cast<std::uint32_t>(edge.normal[1]),
          std::bit_cast<std::uint32_t>(edge.normal[2])};
}

// How many edges were compared.
template <class T>
int expect_the_same(const MemoryVolume& volume, const ContourParameters& parameters) {
  const int side = 32;
  const HaloBlock block{volume.type,           volume.size,   {{}, volume.size},
                        volume.samples.data(), volume.size.x, volume.size.x * volume.size.y};
  SignGrid signs;
  signs.fill(block, {}, side, parameters.surface);
  HermiteEdges edges;
  edges.compute(block, {}, side, signs, parameters);
  const EdgeEstimator<T> one_by_one(block, parameters);
  int count = 0;
  for (int axis = 0; axis < 3; ++axis)
    each_index(splat(side + 1), [&](Index3 p) {
      const auto x = static_cast<int>(p.x), y = static_cast<int>(p.y), z = static_cast<int>(p.z);
      if (!edges.has(axis, x, y, z)) return;
      ++count;
      const HermiteEdge expected = one_by_one.edge(axis, p - splat(1), signs.inside(x, y, z));
      ASSERT_EQ(bits_of(edges.at(axis, x, y, z)), bits_of(expected))
          << "axis " << axis << " at " << x << ' ' << y << ' ' << z;
    });
  return count;
}

// Waves, a crease in the middle, and noise; some samples of floats are none, or infinite.
template <class T>
MemoryVolume rough_volume(SampleType type, double noise, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0, noise);
  return MemoryVolume::made<T>({31, 29, 30}, type, [&](Index3 s) {
    const auto x = static_cast<double>(s.x), y = static_cast<double>(s.y),
               z = static_cast<double>(s.z);
    const double waves = 9 * (std::sin(x / 3) + std::cos(y / 4) + std::sin(z / 2.5));
    const double value = 60 + std::max(waves, 25 - 2 * std::abs(x - 14)) + normal(random);
    if constexpr (std::is_floating_point_v<T>) {
      if (random() % 997 == 0) return std::numeric_limits<T>::quiet_NaN();
      if (random() % 997 == 0) return std::numeric_limits<T>::infinity();
    }
    return static_cast<T>(std::clamp(value, 0.0, 120.0));
  });
}

template <class T>
void expect_the_same_of_type(SampleType type) {
  int count = 0;
  with_all_kernels([&] {
    for (unsigned seed = 0; seed < 4; ++seed)
      for (const Inside inside : {Inside::above, Inside::below}) {
        ContourParameters parameters;
        parameters.spacing = seed % 2 == 0 ? Vec3{1, 1, 1} : Vec3{0.5, 1.25, 2};
        parameters.surface.gradient = Gradient::subcell;
        parameters.surface.isovalue = {60.0 + 0.37 * seed};
        parameters.surface.inside = inside;
        parameters.surface.noise = seed < 2 ? 0 : 0.4;
        count += expect_the_same<T>(rough_volume<T>(type, seed % 3, seed), parameters);
      }
  });
  EXPECT_GT(count, 50000);
}

TEST(EdgeKernels, MakeWhatTheEstimatorMakes) {
  expect_the_same_of_type<std::uint8_t>(SampleType::u8);
  expect_the_same_of_type<std::int16_t>(SampleType::i16);
  expect_the_same_of_type<std::uint32_t>(SampleType::u32);
  expect_the_same_of_type<std::int64_t>(SampleType::i64);
  expect_the_same_of_type<float>(SampleType::f32);
  expect_the_same_of_type<double>(SampleType::f64);
}

// Samples that are no numbers or infinite beside the border of the volume, which ends where the memory does:
// nothing beyond it is read (as the address sanitizer sees), and every edge gets a crossing within it.
TEST(EdgeKernels, OfWildSamplesAtTheBorder) {
  std::mt19937 random(3);
  for (int round = 0; round < 200; ++round) {
    const Index3 size{2 + static_cast<std::int64_t>(random() % 5),
                      2 + static_cast<std::int64_t>(random() % 5),
                      2 + static_cast<std::int64_t>(random() % 5)};
    const auto volume = MemoryVolume::made<float>(size, SampleType::f32, [&](Index3) {
      const auto kind = random() % 8;
      if (kind == 0) return std::numeric_limits<float>::quiet_NaN();
      if (kind < 3) return (kind == 1 ? 1 : -1) * std::numeric_limits<float>::infinity();
      return static_cast<float>(static_cast<int>(random() % 9) - 4);
    });
    ContourParameters parameters;
    parameters.surface.gradient = Gradient::subcell;
    parameters.surface.isovalue = {0.5};
    const HaloBlock block{volume.type,           volume.size,   {{}, volume.size},
                          volume.samples.data(), volume.size.x, volume.size.x * volume.size.y};
    SignGrid signs;
    signs.fill(block, {}, 8, parameters.surface);
    HermiteEdges edges;
    edges.compute(block, {}, 8, signs, parameters);
    for (int axis = 0; axis < 3; ++axis)
      each_index(splat(9), [&](Index3 p) {
        const auto x = static_cast<int>(p.x), y = static_cast<int>(p.y), z = static_cast<int>(p.z);
        if (!edges.has(axis, x, y, z)) return;
        const HermiteEdge& edge = edges.at(axis, x, y, z);
        EXPECT_TRUE(edge.t > 0 && edge.t < 1) << edge.t;
        for (const float n : edge.normal) EXPECT_TRUE(std::isfinite(n));
      });
  }
}

TEST(EdgeKernels, EveryVectorUnitGivesTheSameBits) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal(0, 0.15);
  std::size_t smooth = 0, others = 0;
  for (int round = 0; round < 500; ++round) {
    EdgeStencils stencils;
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      for (std::size_t i = 0; i < 6; ++i)
        stencils.along[i][lane] = static_cast<double>(i) - 2.5 + normal(random);
      for (auto& axis : stencils.beside)
        for (std::size_t end = 0; end < 2; ++end)
          for (auto& sample : axis[end])
            sample[lane] = stencils.along[2 + end][lane] + normal(random);
    }
    const EdgeRule rule{round % 3, 0, round % 2 == 0 ? 1.0 : -1.0, {1, 0.5, 2}, 0.01};
    EdgeLanes expected;
    edge_kernel_base()(stencils, rule, expected);
    for (const std::int64_t lane : expected.smooth) ++(lane != 0 ? smooth : others);
    with_all_kernels([&] {
      EdgeLanes found;
      edge_kernel()(stencils, rule, found);
      EXPECT_EQ(found.smooth, expected.smooth);
      EXPECT_EQ(found.t, expected.t);
      EXPECT_EQ(found.normal, expected.normal);
    });
  }
  EXPECT_GT(smooth, 500U);
  EXPECT_GT(others, 500U);
}

}  // namespace
}  // namespace voxweld
