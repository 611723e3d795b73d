// Winding numbers against sums over all triangles.
#include "stages/solids/winding_number.h"

#include <gtest/gtest.h>

#include "tests/stages/sampled_solid.h"

namespace voxweld {
namespace {

using testing::box_mesh;
using testing::dented_ball;
using testing::nearest;
using testing::winding;

class Random {
 public:
  explicit Random(unsigned seed) : random_(seed) {}
  double in(double lo, double hi) {
    return std::uniform_real_distribution<double>(lo, hi)(random_);
  }
  Vec3 place(double lo, double hi) { return {in(lo, hi), in(lo, hi), in(lo, hi)}; }
  std::mt19937& engine() { return random_; }

 private:
  std::mt19937 random_;
};

// A share of the triangles is gone.
TriangleMesh thinned(TriangleMesh mesh, double share, Random& random) {
  std::erase_if(mesh.triangles, [&](const auto&) { return random.in(0, 1) < share; });
  return mesh;
}

// No triangle shares a corner with another.
TriangleMesh soup(const TriangleMesh& mesh) {
  TriangleMesh apart;
  for (const auto& t : mesh.triangles) {
    const auto first = static_cast<std::uint32_t>(apart.vertices.size());
    for (const std::uint32_t corner : t) apart.vertices.push_back(mesh.vertices[corner]);
    apart.triangles.push_back({first, first + 1, first + 2});
  }
  return apart;
}

std::vector<TriangleMesh> meshes(Random& random) {
  std::vector<TriangleMesh> all = {box_mesh({-5, -6, -7}, {5, 6, 7}), dented_ball({}, 7, 5)};
  all.push_back(thinned(dented_ball({}, 7, 4), 0.02, random));
  all.push_back(thinned(dented_ball({}, 7, 5), 0.4, random));
  TriangleMesh half = dented_ball({}, 7, 5);
  std::erase_if(half.triangles, [&](const auto& t) { return half.vertices[t[0]].z > 1; });
  all.push_back(half);
  TriangleMesh open = box_mesh({-5, -6, -7}, {5, 6, 7});
  open.triangles.resize(10);
  all.push_back(open);
  return all;
}

TEST(WindingNumber, IsTheSumOverAllTriangles) {
  Random random(1);
  for (const TriangleMesh& mesh : meshes(random)) {
    const WindingNumber number(mesh);
    for (int i = 0; i < 300; ++i) {
      const Vec3 p = random.place(-12, 12);
      const double expected = winding(mesh, p);
      EXPECT_NEAR(number.value(p), expected, 1e-9);
      if (std::abs(expected - 0.5) > 1e-9) {
        EXPECT_EQ(number.inside(p), expected > 0.5);
      }
    }
  }
}

// More open edges than are summed up at each point.
TEST(WindingNumber, OfASoup) {
  Random random(2);
  const TriangleMesh mesh = soup(thinned(dented_ball({}, 7, 6), 0.2, random));
  const WindingNumber number(mesh);
  EXPECT_GT(number.open_edges(), std::size_t{1} << 14);
  for (int i = 0; i < 100; ++i) {
    const Vec3 p = random.place(-9, 9);
    const double expected = winding(mesh, p);
    EXPECT_NEAR(number.value(p), expected, 1e-6);
    EXPECT_EQ(number.inside(p), expected > 0.5);
  }
  for (int i = 0; i < 200; ++i) {
    const Vec3 p = random.place(-9, 9), half = random.place(0, 1);
    const Relation side = number.side_of({p - half, p + half});
    if (side == Relation::mixed) continue;
    EXPECT_EQ(winding(mesh, p + half) > 0.5, side == Relation::inside);
  }
}

TEST(WindingNumber, SidesOfBoxesAreThoseOfAllTheirPoints) {
  Random random(3);
  int told = 0;
  for (const TriangleMesh& mesh : meshes(random)) {
    const WindingNumber number(mesh);
    for (int i = 0; i < 200; ++i) {
      const Vec3 p = random.place(-8, 8), half = random.place(0, 2);
      const Relation side = number.side_of({p - half, p + half});
      if (side == Relation::mixed) continue;
      ++told;
      for (int k = 0; k < 10; ++k) {
        const Vec3 d = random.place(-1, 1);
        const Vec3 q = p + Vec3{d.x * half.x, d.y * half.y, d.z * half.z};
        EXPECT_EQ(winding(mesh, q) > 0.5, side == Relation::inside);
      }
    }
  }
  EXPECT_GT(told, 400);
}

TEST(WindingNumber, TouchesWhereTrianglesAre) {
  Random random(4);
  const TriangleMesh mesh = dented_ball({}, 7, 4);
  const WindingNumber number(mesh);
  for (int i = 0; i < 300; ++i) {
    const Vec3 p = random.place(-8, 8), half = random.place(0.2, 1);
    if (nearest(mesh, p) < std::min({half.x, half.y, half.z})) {
      EXPECT_TRUE(number.touches({p - half, p + half}));
    }
    if (nearest(mesh, p) > 4) {
      EXPECT_FALSE(number.touches({p - half, p + half}));
    }
  }
}

TEST(WindingNumber, GradientIsThatOfTheNumber) {
  Random random(5);
  int looked_at = 0;
  for (const TriangleMesh& mesh : meshes(random)) {
    const WindingNumber number(mesh);
    for (int i = 0; i < 60; ++i) {
      const Vec3 p = random.place(-8, 8);
      constexpr double step = 1e-4;
      if (nearest(mesh, p) < 0.2) continue;
      const Vec3 gradient = number.gradient(p);
      for (int a = 0; a < 3; ++a) {
        Vec3 lo = p, hi = p;
        lo[a] -= step;
        hi[a] += step;
        EXPECT_NEAR(gradient[a], (winding(mesh, hi) - winding(mesh, lo)) / (2 * step), 1e-6);
      }
      ++looked_at;
    }
  }
  EXPECT_GT(looked_at, 200);
}

TEST(WindingNumber, MeshesThatFaceInwardAreTurnedAround) {
  Random random(6);
  TriangleMesh mesh = thinned(dented_ball({40, -30, 20}, 7, 4), 0.05, random);
  const WindingNumber first(mesh);
  EXPECT_EQ(first.orientation(), 1);
  for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
  const WindingNumber turned(mesh);
  EXPECT_EQ(turned.orientation(), -1);
  for (int i = 0; i < 100; ++i) {
    const Vec3 p = Vec3{40, -30, 20} + random.place(-9, 9);
    EXPECT_NEAR(first.value(p), turned.value(p), 1e-12);
    EXPECT_EQ(first.inside(p), turned.inside(p));
    const Vec3 change = first.gradient(p) - turned.gradient(p);
    EXPECT_NEAR(dot(change, change), 0, 1e-24);
  }
}

TEST(WindingNumber, OrderOfTrianglesChangesNothing) {
  Random random(7);
  TriangleMesh mesh = thinned(dented_ball({}, 7, 5), 0.1, random);
  const WindingNumber first(mesh);
  std::shuffle(mesh.triangles.begin(), mesh.triangles.end(), random.engine());
  for (auto& t : mesh.triangles) std::rotate(t.begin(), t.begin() + random.engine()() % 3, t.end());
  const WindingNumber second(mesh);
  for (int i = 0; i < 300; ++i) {
    const Vec3 p = random.place(-9, 9);
    EXPECT_EQ(first.value(p), second.value(p));
    EXPECT_EQ(first.gradient(p), second.gradient(p));
  }
}

// Once in either of two boxes, twice in both.
TEST(WindingNumber, OverlapsCountTwice) {
  const WindingNumber number(
      testing::joined(box_mesh({0, 0, 0}, {4, 4, 4}), box_mesh({2, 2, 2}, {6, 6, 6})));
  EXPECT_EQ(number.value({1, 1, 1}), 1);
  EXPECT_EQ(number.value({3, 3, 3}), 2);
  EXPECT_EQ(number.value({5, 5, 5}), 1);
  EXPECT_EQ(number.value({1, 5, 1}), 0);
}

TEST(WindingNumber, LinesMeetTriangles) {
  Random random(8);
  const WindingNumber number(dented_ball({}, 7, 4));
  for (int i = 0; i < 200; ++i) {
    Vec3 from = random.place(-8, 8);
    const int axis = i % 3;
    const double length = random.in(0.5, 9);
    double sum = 0;
    number.each_meeting(from, axis, length, [&](double t, Vec3 normal) {
      EXPECT_GE(t, 0);
      EXPECT_LE(t, 1);
      EXPECT_NEAR(dot(normal, normal), 1, 1e-12);
      sum += normal[axis] > 0 ? -1 : 1;
    });
    const double before = number.value(from);
    from[axis] += length;
    EXPECT_EQ(number.value(from), before + sum);
  }
}

TEST(WindingNumber, OfNothing) {
  const WindingNumber number(TriangleMesh{});
  EXPECT_FALSE(number.inside({1, 2, 3}));
  EXPECT_EQ(number.side_of({{0, 0, 0}, {1, 1, 1}}), Relation::outside);
}

}  // namespace
}  // namespace voxweld
