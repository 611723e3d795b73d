// Crossings and normals near creases, found with subcell resolution.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

#include "stages/build/edge_estimator.h"
#include "tests/support/contour_in_memory.h"
#include "tests/support/lattice_place.h"

namespace voxweld {
namespace {

using testing::MemoryVolume;
using Field = std::function<double(Vec3)>;

// The field's samples, negative inside, and estimates of its edges.
class Sampled {
 public:
  Sampled(Index3 size, const Field& field)
      : volume_(MemoryVolume::made<double>(size, SampleType::f64,
                                           [&](Index3 s) { return field(testing::as_vec3(s)); })) {
    block_.type = SampleType::f64;
    block_.data = volume_.samples.data();
    block_.samples = Box3{{}, size};
    block_.size = size;
    block_.row = size.x;
    block_.slice = size.x * size.y;
  }

  double at(Index3 s) const {
    return reinterpret_cast<const double*>(
        volume_.samples.data())[(s.z * volume_.size.y + s.y) * volume_.size.x + s.x];
  }
  HermiteEdge edge(int axis, Index3 s, Gradient gradient, double noise = 0) const {
    ContourParameters parameters;
    parameters.surface.isovalue = 0;
    parameters.surface.inside = Inside::below;
    parameters.surface.gradient = gradient;
    parameters.surface.noise = noise;
    return EdgeEstimator<double>(block_, parameters).edge(axis, s, at(s) <= 0);
  }
  // f(axis, s) of every crossing edge with `margin` samples to the volume's border.
  template <class F>
  int each_crossing(std::int64_t margin, const F& f) const {
    int count = 0;
    each_index(volume_.size, [&](Index3 s) {
      for (int axis = 0; axis < 3; ++axis) {
        Index3 next = s;
        ++next[axis];
        bool in = true;
        for (int a = 0; a < 3; ++a) in = in && s[a] >= margin && next[a] + margin < volume_.size[a];
        if (!in || (at(s) <= 0) == (at(next) <= 0)) continue;
        ++count;
        f(axis, s);
      }
    });
    return count;
  }

 private:
  MemoryVolume volume_;
  HaloBlock block_;
};

// In each direction along each axis; `along` is 0 at sample 4 and crosses 0 between it and the next.
void expect_crossing(const std::function<double(double)>& along, double t) {
  for (int axis = 0; axis < 3; ++axis)
    for (const bool up : {true, false}) {
      SCOPED_TRACE(::testing::Message() << "axis " << axis << (up ? ", up" : ", down"));
      const Sampled samples(splat(10),
                            [&](Vec3 p) { return along(up ? p[axis] - 4 : 5 - p[axis]); });
      Index3 s = splat(4);
      const HermiteEdge edge = samples.edge(axis, s, Gradient::subcell);
      EXPECT_NEAR(edge.t, up ? t : 1 - t, 1e-7);
      EXPECT_NEAR(edge.normal[static_cast<std::size_t>(axis)], up ? 1 : -1, 1e-7);
    }
}

double straight(double slope, double root, double x) {
  return slope * (x - root);
}
double curved(double slope, double bend, double root, double x) {
  return straight(slope, root, x) + bend * (x - root) * (x - root) / 2;
}

TEST(Subcell, CrossingsOfAKinkedLineAreExact) {
  for (const double a : {0.3, 1.0})
    for (const double b : {1.9, 2.6}) {
      // The larger of the two is 0 where the first of them is, the smaller where the last is.
      expect_crossing([&](double x) { return std::max(straight(a, 0.3, x), straight(b, 0.4, x)); },
                      0.3);
      expect_crossing([&](double x) { return std::max(straight(a, 0.8, x), straight(b, 0.7, x)); },
                      0.7);
      expect_crossing([&](double x) { return std::min(straight(a, 0.3, x), straight(b, 0.2, x)); },
                      0.3);
      expect_crossing([&](double x) { return std::min(straight(b, 0.7, x), straight(a, 0.6, x)); },
                      0.7);
    }
}

TEST(Subcell, SoAreThoseOfCurvedBranches) {
  const auto a = [](double x) { return curved(0.5, 0.06, 0.35, x); };
  const auto b = [](double x) { return curved(2.0, -0.08, 0.55, x); };
  expect_crossing([&](double x) { return std::max(a(x), b(x)); }, 0.35);
  expect_crossing([&](double x) { return std::min(a(x), b(x)); }, 0.55);
}

// A wedge: two planes that meet in a line oblique to the axes.
TEST(Subcell, BothSidesOfACreaseKeepTheirPlanes) {
  const Vec3 m = Vec3{4, 2, 1} * (1 / std::sqrt(21.0)), n = Vec3{1, -4, 2} * (1 / std::sqrt(21.0));
  const Vec3 c{7.6, 8.3, 7.9};
  for (const double sign : {1.0, -1.0}) {
    const Sampled samples(splat(16), [&](Vec3 p) {
      return sign * std::max(sign * dot(m, p - c), sign * dot(n, p - c));
    });
    int exact = 0;
    const int all = samples.each_crossing(3, [&](int axis, Index3 s) {
      const HermiteEdge edge = samples.edge(axis, s, Gradient::subcell);
      Vec3 p = testing::as_vec3(s);
      p[axis] += static_cast<double>(edge.t);
      const double dm = dot(m, p - c), dn = dot(n, p - c);
      const Vec3 plane = std::abs(dm) < std::abs(dn) ? m : n;
      EXPECT_NEAR(sign * std::max(sign * dm, sign * dn), 0, 1e-5);
      const Vec3 normal{edge.normal[0], edge.normal[1], edge.normal[2]};
      EXPECT_GT(dot(plane, normal), std::cos(0.16));  // what is below the least bend remains
      exact += dot(plane, normal) > 1 - 1e-6 ? 1 : 0;
    });
    EXPECT_GT(all, 100);
    EXPECT_GT(exact, all * 9 / 10);
  }
}

TEST(Subcell, WhatIsSmoothIsLeftToCentralDifferences) {
  const Sampled ball(splat(28), [](Vec3 p) {
    const Vec3 d = p - Vec3{13.4, 13.7, 13.1};
    return std::sqrt(dot(d, d)) - 9.3;
  });
  const int all = ball.each_crossing(0, [&](int axis, Index3 s) {
    const HermiteEdge central = ball.edge(axis, s, Gradient::central);
    const HermiteEdge subcell = ball.edge(axis, s, Gradient::subcell);
    EXPECT_EQ(central.t, subcell.t);
    EXPECT_EQ(central.normal, subcell.normal);
  });
  EXPECT_GT(all, 1000);
}

TEST(Subcell, TheGateClosesToKinksThatNoiseCouldMake) {
  const Sampled samples(
      splat(10), [](Vec3 p) { return std::max(straight(0.7, 4.3, p.x), straight(1.2, 4.4, p.x)); });
  const Index3 s{4, 5, 5};
  const HermiteEdge central = samples.edge(0, s, Gradient::central);
  EXPECT_NEAR(samples.edge(0, s, Gradient::subcell).t, 0.3, 1e-7);
  EXPECT_NEAR(samples.edge(0, s, Gradient::subcell, 0.01).t, 0.3, 1e-7);
  EXPECT_EQ(samples.edge(0, s, Gradient::subcell, 0.2).t, central.t);
  EXPECT_GT(std::abs(central.t - 0.3f), 0.05f);
}

TEST(Subcell, OfNoiseThatIsKnownFewSmoothPlacesAreTakenForKinks) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  const Vec3 m = Vec3{4, 2, 3} * (1 / std::sqrt(29.0));
  const Sampled samples(splat(40), [&](Vec3 p) {
    return dot(m, p - Vec3{20, 20, 20}) + 0.1 * normal(random);
  });
  int kinks = 0, blind = 0;
  const int all = samples.each_crossing(0, [&](int axis, Index3 s) {
    const auto central = samples.edge(axis, s, Gradient::central).normal;
    kinks += samples.edge(axis, s, Gradient::subcell, 0.1).normal != central ? 1 : 0;
    blind += samples.edge(axis, s, Gradient::subcell, 0).normal != central ? 1 : 0;
  });
  EXPECT_LT(kinks, all / 50);
  EXPECT_GT(blind, all / 5);
}

// Two samples on each side are needed to see that a step has a kink.
TEST(Subcell, ThinVolumesHaveNone) {
  for (std::int64_t n = 2; n <= 5; ++n) {
    const Sampled samples(
        {n, 3, 1}, [](Vec3 p) { return std::max(straight(0.5, 0.3, p.x), straight(2, 0.4, p.x)); });
    const HermiteEdge central = samples.edge(0, {}, Gradient::central);
    EXPECT_EQ(samples.edge(0, {}, Gradient::subcell).t, central.t);
    EXPECT_EQ(samples.edge(0, {}, Gradient::subcell).normal, central.normal);
  }
}

}  // namespace
}  // namespace voxweld
