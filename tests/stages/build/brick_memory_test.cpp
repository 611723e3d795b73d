// Holds build_brick_bytes against every byte that building a brick allocates.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

#include "stages/build/build_brick.h"
#include "stages/build/label_bricks.h"
#include "storage/types/material.h"
#include "tests/support/allocation_count.h"
#include "tests/support/lattice_place.h"

namespace voxweld {
namespace {

constexpr int level = 6;
constexpr std::int64_t side = (1 << level) + 1;

using Field = std::function<double(double x, double y, double z)>;

struct Samples {
  std::vector<std::uint16_t> values;
  HaloBlock block() const {
    const Index3 size{side, side, side};
    return {
        SampleType::u16, size, {{}, size}, reinterpret_cast<const std::byte*>(values.data()), side,
        side * side};
  }
};

Samples sampled(const Field& field) {
  Samples samples;
  each_index(splat(side), [&](Index3 s) {
    const Vec3 at = testing::as_vec3(s);
    samples.values.push_back(static_cast<std::uint16_t>(30000 + 20000 * field(at.x, at.y, at.z)));
  });
  return samples;
}

double gyroid(double x, double y, double z) {
  const double k = 0.4;
  return (std::sin(k * x) * std::cos(k * y) + std::sin(k * y) * std::cos(k * z) +
          std::sin(k * z) * std::cos(k * x)) /
         1.5;
}

double noise(double, double, double) {
  static std::mt19937 random(3);
  return static_cast<double>(random() % 2001) / 1000 - 1;
}

// The most sheets there can be: lattice points are inside and outside by turns.
double turns(double x, double y, double z) {
  return std::fmod(x + y + z, 2) < 0.5 ? 0.5 : -0.5;
}

double flat(double x, double y, double z) {
  return std::tanh(x + 0.3 * y - 0.1 * z - 40);
}

struct Case {
  std::string name;
  Field field;
};
void PrintTo(const Case& c, std::ostream* out) {
  *out << c.name;
}

class BrickMemory : public ::testing::TestWithParam<Case> {};

// What one brick takes beyond what was there, and what was said it would before anything large.
struct Figures {
  std::uint64_t said = 0, before = 0, taken = 0;
};

Figures figures_of(const HaloBlock& block, const ContourParameters& parameters) {
  Figures figures;
  BrickScratch scratch;
  BrickOctree out;
  const std::uint64_t start = testing::live_bytes();
  testing::forget_peak();
  scratch.reserve = [&](std::uint64_t bytes) {
    figures.said = bytes;
    figures.before = testing::peak_bytes() - start;
  };
  build_brick(block, {{}, level}, parameters, scratch, out);
  figures.taken = testing::peak_bytes() - start;
  return figures;
}

TEST_P(BrickMemory, IsSaidBeforeItIsTakenAndIsEnough) {
  const Samples samples = sampled(GetParam().field);
  for (const bool simplify : {true, false}) {
    ContourParameters parameters;
    parameters.surface.isovalue = 30000;
    parameters.simplify.enabled = simplify;
    const Figures figures = figures_of(samples.block(), parameters);
    EXPECT_GT(figures.taken, 0U);
    EXPECT_LE(figures.taken, figures.said) << "simplify " << simplify;
    EXPECT_LE(figures.said, build_brick_bytes(level));
    // A bit a lattice point, and a word or two for each block of cells.
    EXPECT_LT(figures.before, std::uint64_t{1} << 18);
  }
}

TEST_P(BrickMemory, OfSheetsByThemselvesIsSaidAndEnough) {
  const Samples samples = sampled(GetParam().field);
  ContourParameters parameters;
  parameters.surface.isovalue = 30000;
  parameters.simplify.topology = Topology::manifold;
  for (const double tolerance : {0.01, 10.0}) {
    parameters.simplify.tolerance = tolerance;
    const Figures figures = figures_of(samples.block(), parameters);
    EXPECT_LE(figures.taken, figures.said);
    EXPECT_GT(figures.taken * 6, figures.said);
    EXPECT_LE(figures.said, build_sheets_bytes(level));
    EXPECT_LT(figures.before, std::uint64_t{1} << 18);
  }
}

INSTANTIATE_TEST_SUITE_P(Fields, BrickMemory,
                         ::testing::Values(Case{"gyroid", gyroid}, Case{"noise", noise},
                                           Case{"turns", turns}, Case{"flat", flat}),
                         [](const auto& field) { return field.param.name; });

TEST(BrickMemory, OfAnEmptyBrickIsAFractionOfTheWorst) {
  EXPECT_LT(build_brick_bytes(level, 0) * 20, build_brick_bytes(level));
  EXPECT_LT(build_brick_bytes(level, 15000) * 8, build_brick_bytes(level));
  EXPECT_EQ(build_brick_bytes(level, std::uint64_t{1} << 3 * level), build_brick_bytes(level));
}

TEST(BrickMemory, FreedBuffersAreGivenBackAndTheNextBrickIsTheSame) {
  const Samples samples = sampled(gyroid);
  ContourParameters parameters;
  parameters.surface.isovalue = 30000;
  BrickScratch scratch;
  BrickOctree first, second;
  build_brick(samples.block(), {{}, level}, parameters, scratch, first);
  const std::uint64_t before = testing::live_bytes();
  scratch.free_buffers();
  EXPECT_LT(testing::live_bytes() + 1000000, before);
  // Also while a brick is under way, as a worker does that has to wait for memory.
  scratch.reserve = [&](std::uint64_t) { scratch.free_buffers(); };
  build_brick(samples.block(), {{}, level}, parameters, scratch, second);
  EXPECT_EQ(first.vertices.size(), second.vertices.size());
  EXPECT_EQ(0, std::memcmp(first.vertices.data(), second.vertices.data(),
                           first.vertices.size() * sizeof(LeafVertex)));
  EXPECT_EQ(0, std::memcmp(first.polygons.data(), second.polygons.data(),
                           first.polygons.size() * sizeof(PolygonRefs)));
}

// Between labels what is fixed is build_labels_bytes, which a worker sets aside.
TEST(BrickMemory, OfSharedLabelsIsEnoughBesideWhatLabelsTake) {
  Samples samples = sampled(noise);
  for (std::uint16_t& value : samples.values) value %= 7;
  ContourParameters parameters;
  parameters.labels.mode = LabelMode::shared;
  MaterialRules rules;
  rules.others = true;
  parameters.labels.rules = std::make_shared<const MaterialRules>(rules);
  const Figures figures = figures_of(samples.block(), parameters);
  EXPECT_GT(figures.said, 0U);
  EXPECT_LE(figures.taken, figures.said + build_labels_bytes(level));
}

}  // namespace
}  // namespace voxweld
