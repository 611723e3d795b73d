// Signs against those of plain 128-bit arithmetic.
#include "stages/exact/orientation.h"

#include <gtest/gtest.h>

#include <random>

namespace voxweld {
namespace {

constexpr std::int32_t most = (1 << 22) - 1;

int plain_orientation(const LatticePoint& p, const LatticePoint& q, const LatticePoint& r,
                      const LatticePoint& s) {
  const Index3 a = lattice_vector(p, q), b = lattice_vector(p, r), c = lattice_vector(p, s);
  const auto minor = [](Int128 u, Int128 v, Int128 w, Int128 x) { return u * x - v * w; };
  return sign_of(minor(a.x, a.y, b.x, b.y) * c.z - minor(a.x, a.z, b.x, b.z) * c.y +
                 minor(a.y, a.z, b.y, b.z) * c.x);
}

TEST(Orientation, IsPositiveWhereTheTriangleRunsCounterClockwise) {
  const LatticePoint o{5, 5, 5}, x{6, 5, 5}, y{5, 6, 5}, above{5, 5, 9}, below{5, 5, 4};
  EXPECT_EQ(orientation(o, x, y, above), 1);
  EXPECT_EQ(orientation(o, x, y, below), -1);
  EXPECT_EQ(orientation(o, x, y, LatticePoint{900, 7, 5}), 0);
  EXPECT_EQ(orientation(o, x, y, 2), 1);
  EXPECT_EQ(orientation(o, y, x, 2), -1);
  EXPECT_EQ(orientation(o, x, LatticePoint{9, 5, 5}, 2), 0);
}

TEST(Orientation, EqualsPlainArithmeticOverTheWholeLattice) {
  std::mt19937_64 random(1);
  std::uniform_int_distribution<std::int32_t> any(0, most);
  const auto point = [&] { return LatticePoint{any(random), any(random), any(random)}; };
  for (int i = 0; i < 100000; ++i) {
    const LatticePoint p = point(), q = point(), r = point(), s = point();
    ASSERT_EQ(orientation(p, q, r, s), plain_orientation(p, q, r, s));
  }
}

// Points next to a plane: double alone gets these wrong.
TEST(Orientation, IsExactNextToThePlane) {
  std::mt19937_64 random(2);
  std::uniform_int_distribution<std::int32_t> any(0, most / 4), step(-1, 1);
  int on = 0, rounded_away = 0;
  for (int i = 0; i < 100000; ++i) {
    const LatticePoint p{any(random), any(random), any(random)},
        q{any(random), any(random), any(random)}, r{any(random), any(random), any(random)};
    LatticePoint s{};
    for (std::size_t a = 0; a < 3; ++a)
      s[a] = std::clamp(q[a] + r[a] - p[a] + (i % 2) * step(random), 0, most);
    const int expected = plain_orientation(p, q, r, s);
    ASSERT_EQ(orientation(p, q, r, s), expected);
    on += expected == 0;
    const Index3 n = exact_normal(p, q, r), v = lattice_vector(p, s);
    const auto in_double = static_cast<double>(n.x) * static_cast<double>(v.x) +
                           static_cast<double>(n.y) * static_cast<double>(v.y) +
                           static_cast<double>(n.z) * static_cast<double>(v.z);
    rounded_away += sign_of(in_double) != expected;
  }
  EXPECT_GT(on, 1000);
  EXPECT_GT(rounded_away, 100);  // else this test is none of the exact part
}

}  // namespace
}  // namespace voxweld
