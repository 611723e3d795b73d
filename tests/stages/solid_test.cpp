#include "stages/solids/solid.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace voxweld {
namespace {

constexpr SolidShape shapes[] = {SolidShape::sphere, SolidShape::box,   SolidShape::cylinder,
                                 SolidShape::cone,   SolidShape::torus, SolidShape::plane};

class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  double real(double lo, double hi) {
    return std::uniform_real_distribution<double>(lo, hi)(engine_);
  }
  Vec3 vector(double size) { return {real(-size, size), real(-size, size), real(-size, size)}; }

  Solid solid(SolidShape shape) {
    Solid s;
    s.shape = shape;
    s.center = vector(5);
    Vec3 z = vector(1);
    z = z * (1 / std::sqrt(dot(z, z)));
    Vec3 x = cross(z, {0.3, 0.5, -0.8});
    x = x * (1 / std::sqrt(dot(x, x)));
    s.axes = {x, cross(z, x), z};
    s.size = {real(1, 8), real(1, 8), real(1, 8)};
    s.radius = real(2, 5);
    s.height = real(1, 8);
    s.tube = real(0.5, 2);
    return s;
  }

 private:
  std::mt19937 engine_;
};

double length(Vec3 v) {
  return std::sqrt(dot(v, v));
}

TEST(Solid, HoldsWhatItsDefinitionSays) {
  Solid s;
  s.center = {1, 2, 3};
  s.radius = 2;
  s.height = 6;
  s.tube = 0.5;
  s.size = {2, 4, 6};
  const auto holds = [&](SolidShape shape, Vec3 p) {
    s.shape = shape;
    return solid_holds(s, s.center + p);
  };
  EXPECT_TRUE(holds(SolidShape::sphere, {2, 0, 0}));
  EXPECT_FALSE(holds(SolidShape::sphere, {1.5, 1.5, 0}));
  EXPECT_TRUE(holds(SolidShape::box, {1, -2, 3}));
  EXPECT_FALSE(holds(SolidShape::box, {1.01, 0, 0}));
  EXPECT_TRUE(holds(SolidShape::cylinder, {0, 2, -3}));
  EXPECT_FALSE(holds(SolidShape::cylinder, {0, 2, 3.01}));
  EXPECT_TRUE(holds(SolidShape::cone, {2, 0, -3}));
  EXPECT_TRUE(holds(SolidShape::cone, {0, 0, 3}));
  EXPECT_TRUE(holds(SolidShape::cone, {0.99, 0, 0}));
  EXPECT_FALSE(holds(SolidShape::cone, {1.01, 0, 0}));
  EXPECT_TRUE(holds(SolidShape::torus, {0, 2.5, 0}));
  EXPECT_FALSE(holds(SolidShape::torus, {0, 0, 0}));
  EXPECT_TRUE(holds(SolidShape::plane, {9, 9, 0}));
  EXPECT_FALSE(holds(SolidShape::plane, {0, 0, 0.01}));
}

// On the surface the normal is the direction in which the value grows fastest.
TEST(Solid, CrossingsAreOnTheSurfaceAndNormalsAcrossIt) {
  Random random(1);
  for (const SolidShape shape : shapes)
    for (int turn = 0, crossings = 0; crossings < 300 && turn < 300000; ++turn) {
      const Solid s = random.solid(shape);
      const Vec3 low = s.center + random.vector(7);
      const int axis = turn % 3;
      Vec3 high = low;
      high[axis] += 0.7;
      if (solid_holds(s, low) == solid_holds(s, high)) continue;
      ++crossings;
      Vec3 p = low;
      p[axis] += 0.7 * solid_crossing(s, low, axis, 0.7);
      ASSERT_NEAR(solid_value(s, p), 0, 1e-10);
      const Vec3 n = solid_normal(s, p);
      ASSERT_NEAR(length(n), 1, 1e-12);
      constexpr double step = 1e-6;
      ASSERT_NEAR(solid_value(s, p + n * step), step, 1e-8) << static_cast<int>(shape);
      ASSERT_NEAR(solid_value(s, p - n * step), -step, 1e-8) << static_cast<int>(shape);
    }
}

TEST(Solid, BoundsHoldItTightly) {
  Random random(2);
  for (const SolidShape shape : shapes) {
    if (shape == SolidShape::plane) continue;
    for (int turn = 0; turn < 50; ++turn) {
      const Solid s = random.solid(shape);
      const Bounds bounds = solid_bounds(s);
      for (int i = 0; i < 2000; ++i) {
        const Vec3 p = s.center + random.vector(9);
        if (!solid_holds(s, p)) continue;
        for (int a = 0; a < 3; ++a) {
          ASSERT_GE(p[a], bounds.lo[a]);
          ASSERT_LE(p[a], bounds.hi[a]);
        }
      }
    }
  }
}

Bounds random_box(Random& random, Vec3 around) {
  const Vec3 at = around + random.vector(6);
  const double side = random.real(0.1, 4);
  return {at, at + Vec3{side, side * random.real(0.5, 1), side}};
}

Vec3 point_in(Random& random, const Bounds& box) {
  return {random.real(box.lo.x, box.hi.x), random.real(box.lo.y, box.hi.y),
          random.real(box.lo.z, box.hi.z)};
}

TEST(Solid, RelationIsNeverWrong) {
  Random random(3);
  for (const SolidShape shape : shapes) {
    int certain[2] = {0, 0};
    for (int turn = 0; turn < 3000; ++turn) {
      const Solid s = random.solid(shape);
      const Bounds box = random_box(random, s.center);
      const Relation relation = relation_to(s, box);
      if (relation == Relation::mixed) continue;
      ++certain[relation == Relation::inside];
      for (int i = 0; i < 50; ++i)
        ASSERT_EQ(solid_holds(s, point_in(random, box)), relation == Relation::inside);
    }
    EXPECT_GT(certain[0], 100) << static_cast<int>(shape);
    if (shape != SolidShape::torus) {
      EXPECT_GT(certain[1], 10) << static_cast<int>(shape);
    }
  }
}

bool after(const std::vector<Edit>& edits, Vec3 p, bool inside) {
  for (const Edit& edit : edits) {
    const bool held = solid_holds(edit.solid, p);
    inside = edit.op == EditOp::add        ? inside || held
             : edit.op == EditOp::subtract ? inside && !held
                                           : inside && held;
  }
  return inside;
}

TEST(Solid, EditsThatDoNotReachABoxChangeNothingInIt) {
  Random random(4);
  int unreached = 0, decided = 0;
  for (int turn = 0; turn < 4000; ++turn) {
    std::vector<Edit> edits;
    for (int i = 0; i < 3; ++i)
      edits.push_back(
          {static_cast<EditOp>((turn + i * 7) % 3), random.solid(shapes[(turn + i) % 6])});
    const Bounds box = random_box(random, edits[0].solid.center);
    std::vector<Edit> reaching;
    for (const Edit& edit : edits)
      if (edit_reaches(edit, box)) reaching.push_back(edit);
    unreached += static_cast<int>(edits.size() - reaching.size());
    for (const Relation before : {Relation::outside, Relation::inside}) {
      const bool inside = before == Relation::inside;
      const Relation side = side_after(edits, box, before);
      decided += side != Relation::mixed;
      for (int i = 0; i < 20; ++i) {
        const Vec3 p = point_in(random, box);
        ASSERT_EQ(after(edits, p, inside), after(reaching, p, inside));
        if (side == Relation::mixed) continue;
        ASSERT_EQ(after(edits, p, inside), side == Relation::inside);
      }
    }
  }
  EXPECT_GT(unreached, 1000);
  EXPECT_GT(decided, 1000);
}

}  // namespace
}  // namespace voxweld
