#include "pipeline/phantom/porous_field.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "pipeline/phantom/lattice_fields.h"

namespace voxweld {
namespace {

double byte_sum(std::uint64_t bits) {
  return static_cast<double>((bits & 255) + (bits >> 8 & 255) + (bits >> 16 & 255) +
                             (bits >> 24 & 255));
}

// One box blur of width 11 along an axis, wrapping, by its definition.
std::vector<double> box_blur(const std::vector<double>& v, std::int64_t n, int axis) {
  std::vector<double> out(v.size());
  for (std::int64_t i = 0; i < n * n * n; ++i) {
    Index3 p{i % n, i / n % n, i / n / n};
    const std::int64_t at = p[axis];
    double sum = 0;
    for (std::int64_t j = -5; j <= 5; ++j) {
      p[axis] = ((at + j) % n + n) % n;
      sum += v[static_cast<std::size_t>((p.z * n + p.y) * n + p.x)];
    }
    out[static_cast<std::size_t>(i)] = sum / 11;
  }
  return out;
}

TEST(Porous, IsTheBlurredNoiseOfItsDefinition) {
  for (const std::int64_t n : {36, 20}) {  // 20: the blur reaches around the volume
    const std::uint64_t seed = 9;
    std::vector<double> w, noise;
    for (std::int64_t z = 0; z < n; ++z)
      for (std::int64_t y = 0; y < n; ++y)
        for (std::int64_t x = 0; x < n; ++x) {
          const std::uint64_t hash = mix_bits(row_key(seed, y, z), static_cast<std::uint64_t>(x));
          w.push_back(byte_sum(hash) - 510);
          noise.push_back((byte_sum(hash >> 32) - 510) / std::sqrt(65535.0 / 3));
        }
    for (int axis = 0; axis < 3; ++axis)
      for (int pass = 0; pass < 3; ++pass) w = box_blur(w, n, axis);
    const double deviation = std::sqrt(PorousField::blurred_variance(n)) / std::pow(11.0, 9);
    std::vector<double> values(w.size());
    PorousField(n, seed).fill({{0, 0, 0}, splat(n)}, std::numeric_limits<double>::infinity(),
                              values.data());
    for (std::int64_t i = 0; i < n * n * n; ++i) {
      const Index3 p{i % n, i / n % n, i / n / n};
      const bool border =
          p.x == 0 || p.y == 0 || p.z == 0 || p.x == n - 1 || p.y == n - 1 || p.z == n - 1;
      const auto k = static_cast<std::size_t>(i);
      const double solid = border ? -4 : w[k] / deviation - 0.4;
      ASSERT_NEAR(values[k], -(solid + 0.015 * noise[k]) * 8, 1e-7);
    }
  }
}

TEST(Porous, VarianceIsOne) {
  const std::int64_t n = 128;
  std::vector<double> values(static_cast<std::size_t>(n * n * n));
  PorousField(n, 1).fill({{0, 0, 0}, splat(n)}, std::numeric_limits<double>::infinity(),
                         values.data());
  double sum = 0, squares = 0, count = 0;
  for (std::int64_t z = 1; z < n - 1; ++z)
    for (std::int64_t y = 1; y < n - 1; ++y)
      for (std::int64_t x = 1; x < n - 1; ++x) {
        const double w = 0.4 - values[static_cast<std::size_t>((z * n + y) * n + x)] / 8;
        sum += w;
        squares += w * w;
        ++count;
      }
  EXPECT_NEAR(sum / count, 0, 0.1);
  EXPECT_NEAR(squares / count - sum * sum / count / count, 1, 0.05);
}

}  // namespace
}  // namespace voxweld
