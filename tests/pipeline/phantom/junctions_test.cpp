// The interfaces of junctions against points that are on them because the label changes there.
#include "pipeline/phantom/junctions_field.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <random>
#include <set>

#include "pipeline/phantom/phantom_source.h"
#include "storage/support/error.h"
#include "storage/types/label_range.h"
#include "tests/support/error_text.h"

namespace voxweld {
namespace {

constexpr std::int64_t grid_size = 101;
constexpr double middle = 50, ball_radius = 20.2;
const Vec3 wedges{middle - 25.25, middle, middle}, foam{middle + 25.25, middle, middle};

double distance(Vec3 a, Vec3 b) {
  const Vec3 d = a - b;
  return std::sqrt(dot(d, d));
}

Vec3 somewhere(std::mt19937_64& random, double side = 101) {
  std::uniform_real_distribution<double> at(0, side);
  return {at(random), at(random), at(random)};
}

using Pair = std::pair<std::uint64_t, std::uint64_t>;
std::vector<Pair> all_pairs() {
  return {{0, 1}, {0, 2}, {0, 3}, {0, 4}, {0, 5}, {0, 6}, {0, 7}, {1, 2},
          {1, 3}, {2, 3}, {4, 5}, {4, 6}, {4, 7}, {5, 6}, {5, 7}, {6, 7}};
}

// Where the label changes between two places near each other.
std::map<Pair, std::vector<Vec3>> changes(const JunctionsField& field, int count) {
  std::mt19937_64 random(1);
  std::map<Pair, std::vector<Vec3>> found;
  for (int i = 0; i < count; ++i) {
    Vec3 a = somewhere(random);
    Vec3 b = a + (somewhere(random, 2) - Vec3{1, 1, 1});
    if (field.label_at(a) == field.label_at(b)) continue;
    for (int step = 0; step < 60; ++step) {
      const Vec3 m = (a + b) * 0.5;
      (field.label_at(m) == field.label_at(a) ? a : b) = m;
    }
    found[std::minmax(field.label_at(a), field.label_at(b))].push_back(a);
  }
  return found;
}

TEST(Junctions, InterfacesAreWhereTheLabelChanges) {
  const JunctionsField field(grid_size);
  const auto found = changes(field, 4'000'000);
  ASSERT_EQ(found.size(), all_pairs().size());
  std::mt19937_64 random(2);
  for (const auto& [pair, points] : found) {
    const auto [a, b] = pair;
    for (const Vec3& point : points) {
      ASSERT_LT(field.interface_distance(point, a, b), 1e-9);
      ASSERT_LT(field.surface_distance(point), 1e-9);
    }
    // No point of it is nearer than the distance, and some is nearly as near.
    for (int i = 0; i < 50; ++i) {
      const Vec3 p = somewhere(random);
      double nearest = 1e9;
      for (const Vec3& point : points) nearest = std::min(nearest, distance(p, point));
      const double exact = field.interface_distance(p, b, a);
      ASSERT_LE(exact, nearest + 1e-9);
      ASSERT_LE(nearest, exact + 1.5) << a << " " << b << " " << points.size();
    }
  }
}

TEST(Junctions, TheSurfaceIsTheNearestInterface) {
  const JunctionsField field(grid_size);
  std::mt19937_64 random(3);
  for (int i = 0; i < 2000; ++i) {
    const Vec3 p = somewhere(random);
    double nearest = 1e9;
    for (const auto& [a, b] : all_pairs())
      nearest = std::min(nearest, field.interface_distance(p, a, b));
    EXPECT_NEAR(field.surface_distance(p), nearest, 1e-9);
    EXPECT_LE(field.surface_distance(p), field.curve_distance(p));
    EXPECT_LE(field.curve_distance(p), field.corner_distance(p));
  }
  EXPECT_EQ(field.interface_distance({1, 2, 3}, 1, 4), std::numeric_limits<double>::infinity());
  EXPECT_EQ(field.interface_distance({1, 2, 3}, 2, 2), std::numeric_limits<double>::infinity());
  EXPECT_EQ(field.interface_distance({1, 2, 3}, 0, 8), std::numeric_limits<double>::infinity());
}

// The labels within `reach` of a place.
std::set<std::uint64_t> labels_near(const JunctionsField& field, Vec3 p, double reach) {
  std::mt19937_64 random(4);
  std::set<std::uint64_t> labels;
  for (int i = 0; i < 400; ++i)
    labels.insert(field.label_at(p + (somewhere(random, 2 * reach) - Vec3{reach, reach, reach})));
  return labels;
}

TEST(Junctions, CurvesAreWhereThreeMeet) {
  const JunctionsField field(grid_size);
  std::mt19937_64 random(5);
  constexpr double reach = 0.5;
  int near = 0;
  for (int i = 0; i < 400'000; ++i) {
    const Vec3 p = somewhere(random);
    const double to_curve = field.curve_distance(p);
    const bool is_near = to_curve < 0.4 * reach;
    if (!is_near && i % 40 != 0) continue;
    const std::size_t labels = labels_near(field, p, reach).size();
    // Interfaces meet at right angles or wider.
    ASSERT_TRUE(to_curve <= std::sqrt(6.0) * reach || labels <= 2);
    if (!is_near) continue;
    ++near;
    ASSERT_GE(labels, 3U);
  }
  EXPECT_GT(near, 10);
}

TEST(Junctions, CornersAreWhereFourMeet) {
  const JunctionsField field(grid_size);
  EXPECT_LT(field.corner_distance(foam), 1e-12);
  EXPECT_EQ(labels_near(field, foam, 0.3), (std::set<std::uint64_t>{4, 5, 6, 7}));
  EXPECT_EQ(labels_near(field, wedges, 0.3), (std::set<std::uint64_t>{1, 2, 3}));
  EXPECT_LT(field.curve_distance(wedges), 1e-12);
  EXPECT_NEAR(field.corner_distance(wedges), ball_radius, 1e-12);
  // The diameter: M^T z with M = Rz(0.37) Ry(0.61) Rx(0.23).
  const Vec3 axis{-std::sin(0.61), std::sin(0.23) * std::cos(0.61),
                  std::cos(0.23) * std::cos(0.61)};
  for (const double side : {-1.0, 1.0}) {
    const Vec3 end = wedges + axis * (side * ball_radius);
    EXPECT_LT(field.corner_distance(end), 1e-9);
    EXPECT_EQ(labels_near(field, end, 0.4), (std::set<std::uint64_t>{0, 1, 2, 3}));
    EXPECT_LT(field.curve_distance(wedges + axis * (side * 7)), 1e-9);
  }
  // The lines of the foam are at the angle of a tetrahedron's.
  int corners = 0;
  for (double u = -1; u <= 1; u += 0.01)
    for (double a = 0; a < 6.28; a += 0.01) {
      const double s = std::sqrt(1 - u * u);
      const Vec3 p = foam + Vec3{s * std::cos(a), s * std::sin(a), u} * ball_radius;
      if (field.corner_distance(p) > 0.15) continue;
      ++corners;
      ASSERT_EQ(labels_near(field, p, 1.0).size(), 4U);
    }
  EXPECT_GT(corners, 4);
}

TEST(Junctions, HaveTheVolumesOfTheirShares) {
  const PhantomSource source(
      {.kind = PhantomKind::junctions, .size = grid_size, .type = SampleType::u8});
  std::vector<std::byte> samples(static_cast<std::size_t>(grid_size * grid_size * grid_size));
  source.read({{}, splat(grid_size)}, samples.data());
  std::map<int, double> counts;
  for (const std::byte sample : samples) counts[std::to_integer<int>(sample)] += 1;
  EXPECT_EQ(counts.size(), 8U);
  const JunctionsField field(grid_size);
  for (std::uint64_t label = 1; label <= 7; ++label)
    EXPECT_NEAR(counts[static_cast<int>(label)] / field.volume(label), 1, 0.02) << label;
}

// Labels of any type, wherever they begin.
TEST(Junctions, LabelsMayBeWide) {
  const auto samples_of = [](SampleType type, std::uint64_t first) {
    const PhantomSource source(
        {.kind = PhantomKind::junctions, .size = 21, .type = type, .first_label = first});
    std::vector<std::byte> samples(21 * 21 * 21 * sample_bytes(type));
    source.read({{}, splat(21)}, samples.data());
    return samples;
  };
  const auto small = samples_of(SampleType::u8, 1);
  for (const std::uint64_t first :
       {std::uint64_t{1}, (std::uint64_t{1} << 63) - 3, highest_label - 6}) {
    const auto wide = samples_of(SampleType::u64, first);
    for (std::size_t i = 0; i < small.size(); ++i) {
      std::uint64_t sample = 0;
      std::memcpy(&sample, wide.data() + 8 * i, 8);
      const auto label = std::to_integer<std::uint64_t>(small[i]);
      ASSERT_EQ(sample, label == 0 ? 0 : first + label - 1);
    }
  }
  const auto refused = [&](SampleType type, std::uint64_t first) {
    return testing::error_text<InputError>([&] { samples_of(type, first); });
  };
  EXPECT_EQ(refused(SampleType::i8, 121), "accepted");
  EXPECT_EQ(refused(SampleType::i8, 122),
            "phantom junctions: 7 labels from 122 on do not fit int8, whose labels end at 127");
  EXPECT_EQ(refused(SampleType::u64, highest_label - 5),
            "phantom junctions: 7 labels from 18446744073709551609 on do not fit uint64, whose "
            "labels end at 18446744073709551614");
  EXPECT_NE(refused(SampleType::u8, 0), "accepted");
  EXPECT_NE(refused(SampleType::f32, 1), "accepted");
  EXPECT_THROW(PhantomSource({.kind = PhantomKind::labels, .type = SampleType::i8}), InputError);
}

}  // namespace
}  // namespace voxweld
