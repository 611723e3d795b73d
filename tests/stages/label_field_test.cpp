// Labels' crossings and normals against the true surfaces of solids that were made voxels.
#include "stages/build/label_field.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "stages/build/hermite.h"
#include "stages/solids/solid.h"
#include "tests/support/lattice_place.h"

namespace voxweld {
namespace {

// Labels of a cube of samples: 7 in the solid, 3 around it.
struct Voxels {
  Index3 size;
  std::vector<std::uint16_t> labels;

  Voxels(const Solid& solid, std::int64_t side) : size(splat(side)) {
    each_index(
        size, [&](Index3 s) { labels.push_back(solid_holds(solid, testing::as_vec3(s)) ? 7 : 3); });
  }
  HaloBlock block() const {
    return {SampleType::u16, size,
            {{}, size},      reinterpret_cast<const std::byte*>(labels.data()),
            size.x,          size.x * size.y};
  }
};

struct Errors {
  double distance = 0, degrees = 0;  // root mean square; mean
  std::size_t edges = 0;
};

class Measured {
 public:
  Measured(const Solid& solid, int side) : solid_(solid), side_(side), voxels_(solid, side - 1) {
    SurfaceParameters surface;
    surface.label = 7;
    signs_.fill(voxels_.block(), {}, side, surface);
    edges_.compute_label(field_.filter(voxels_.block(), 7, {{}, voxels_.size}), {}, side, signs_,
                         Box3{{}, splat(side + 1)}, {1, 1, 1});
  }

  Errors of_filter() const {
    return sum(
        [&](int axis, Index3 at) { return edges_.at(axis, int(at.x), int(at.y), int(at.z)); });
  }
  // t of the edges along z above `at`.
  std::vector<float> crossings_of_column(Index3 at) const {
    std::vector<float> crossings;
    for (; at.z < side_ - 1; ++at.z)
      if (inside(at) != inside(at + Index3{0, 0, 1}))
        crossings.push_back(edges_.at(2, int(at.x), int(at.y), int(at.z)).t);
    return crossings;
  }
  Errors of_midpoints() const {
    return sum([&](int axis, Index3 at) {
      HermiteEdge edge;
      edge.t = 0.5f;
      edge.normal[static_cast<std::size_t>(axis)] = inside(at) ? 1.0f : -1.0f;
      return edge;
    });
  }

 private:
  bool inside(Index3 at) const { return signs_.inside(int(at.x), int(at.y), int(at.z)); }

  // Lattice point u is sample u - 1; edges of real samples only.
  template <class F>
  Errors sum(F&& edge_of) const {
    Errors errors;
    for (int axis = 0; axis < 3; ++axis)
      each_index({splat(1), splat(side_ - 1)}, [&](Index3 at) {
        Index3 next = at;
        ++next[axis];
        if (inside(at) == inside(next)) return;
        const HermiteEdge edge = edge_of(axis, at);
        Vec3 p = testing::as_vec3(at - splat(1));
        p[axis] += static_cast<double>(edge.t);
        const Vec3 normal{edge.normal[0], edge.normal[1], edge.normal[2]};
        const double value = solid_value(solid_, p);
        errors.distance += value * value;
        errors.degrees +=
            std::acos(std::clamp(dot(normal, solid_normal(solid_, p)), -1.0, 1.0)) * 57.29578;
        ++errors.edges;
      });
    const auto n = static_cast<double>(errors.edges);
    errors.distance = std::sqrt(errors.distance / n);
    errors.degrees /= n;
    return errors;
  }

  Solid solid_;
  int side_;
  Voxels voxels_;
  SignGrid signs_;
  LabelField field_;
  HermiteEdges edges_;
};

Solid solid_of(SolidShape shape, double radius) {
  Solid s;
  s.shape = shape;
  s.center = {31.4, 30.7, 31.1};
  s.radius = radius;
  s.tube = 5;
  const double a = 0.8, b = 0.6;
  s.axes = {Vec3{a, b, 0}, Vec3{-b * a, a * a, b}, Vec3{b * b, -a * b, a}};
  return s;
}

TEST(LabelField, HalvesTheDistanceAndMendsTheNormals) {
  struct Case {
    SolidShape shape;
    double radius, distance, degrees;
  };
  for (const Case& c : {Case{SolidShape::sphere, 20, 0.10, 3.5},
                        {SolidShape::sphere, 10, 0.11, 3.5},
                        {SolidShape::torus, 15, 0.11, 3.5},
                        {SolidShape::plane, 0, 0.08, 3.5}}) {
    const Measured measured(solid_of(c.shape, c.radius), 64);
    const Errors mid = measured.of_midpoints(), filtered = measured.of_filter();
    EXPECT_GT(mid.edges, 1000u);
    EXPECT_LT(filtered.distance, c.distance) << "midpoints: " << mid.distance;
    EXPECT_LT(filtered.degrees, c.degrees) << "midpoints: " << mid.degrees;
    EXPECT_GT(mid.distance, 0.17);
    EXPECT_GT(mid.degrees, 30);
  }
}

// Of the edges out of the solid along z in its middle column, from the lower to the upper.
std::vector<float> crossings_of_sheet(std::int64_t thickness) {
  Solid sheet;
  sheet.shape = SolidShape::box;
  sheet.size = {100, 100, static_cast<double>(thickness)};
  sheet.center = {16, 16, 16 + 0.5 * static_cast<double>(thickness - 1)};
  return Measured(sheet, 34).crossings_of_column({17, 17, 0});
}

TEST(LabelField, ThinLabelsStayAsThickAsTheirSamples) {
  // At half a sample below the first and above the last.
  EXPECT_EQ(crossings_of_sheet(1), (std::vector<float>{0.5f, 0.5f}));
  for (const std::int64_t thickness : {2, 3, 4, 8}) {
    const std::vector<float> t = crossings_of_sheet(thickness);
    ASSERT_EQ(t.size(), 2u);
    EXPECT_NEAR(t[0], 0.5, 0.07) << thickness;
    EXPECT_FLOAT_EQ(t[0] + t[1], 1) << thickness;
  }
  // One sample, and a row of them.
  Solid dot;
  dot.shape = SolidShape::box;
  dot.center = {16, 16, 16};
  dot.size = {1, 1, 1};
  EXPECT_EQ(Measured(dot, 34).crossings_of_column({17, 17, 0}), (std::vector<float>{0.5f, 0.5f}));
  dot.size.x = 100;
  EXPECT_EQ(Measured(dot, 34).crossings_of_column({17, 17, 0}), (std::vector<float>{0.5f, 0.5f}));
}

TEST(LabelField, IsTheBinomialFilterOfTheIndicator) {
  std::mt19937 random(1);
  Voxels voxels(solid_of(SolidShape::sphere, 3), 9);
  for (std::uint16_t& label : voxels.labels) label = static_cast<std::uint16_t>(random() % 3);
  LabelField field;
  const Box3 box{{0, 2, 5}, {9, 7, 9}};
  const HaloBlock out = field.filter(voxels.block(), 1, box);
  EXPECT_EQ(out.type, SampleType::i32);
  EXPECT_EQ(out.samples, box);
  const auto* data = reinterpret_cast<const std::int32_t*>(out.data);
  constexpr int weight[5] = {1, 4, 6, 4, 1};
  for (Index3 at = box.lo; at.z < box.hi.z; ++at.z)
    for (at.y = box.lo.y; at.y < box.hi.y; ++at.y)
      for (at.x = box.lo.x; at.x < box.hi.x; ++at.x) {
        int expected = 0;
        for (int i = 0; i < 125; ++i) {
          const Index3 k{i % 5, i / 5 % 5, i / 25};
          Index3 s;
          for (int a = 0; a < 3; ++a)
            s[a] = std::clamp<std::int64_t>(at[a] + k[a] - 2, 0, voxels.size[a] - 1);
          const auto index = static_cast<std::size_t>((s.z * 9 + s.y) * 9 + s.x);
          if (voxels.labels[index] == 1) expected += weight[k.x] * weight[k.y] * weight[k.z];
        }
        const Index3 d = at - box.lo;
        ASSERT_EQ(data[d.z * out.slice + d.y * out.row + d.x], expected);
      }
}

TEST(LabelField, LabelsAreComparedInTheSamplesType) {
  EXPECT_TRUE(LabelTest<std::uint8_t>(200)(200));
  EXPECT_TRUE(LabelTest<std::uint8_t>(456).never);  // 200 in its low byte
  EXPECT_TRUE(LabelTest<std::int8_t>(200).never);
  EXPECT_TRUE(LabelTest<std::uint64_t>(0x8000000000000001u)(0x8000000000000001u));
  EXPECT_FALSE(LabelTest<std::uint64_t>(0x8000000000000001u)(0x8000000000000000u));
}

}  // namespace
}  // namespace voxweld
