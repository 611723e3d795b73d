// One label of a brick built from its own box is, bit for bit, what the whole brick gives.
#include "stages/build/label_extents.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cstring>
#include <random>
#include <set>
#include <sstream>

#include "stages/build/material_block.h"

namespace voxweld {
namespace {

struct Labels {
  Index3 size;
  std::vector<std::uint32_t> samples;

  HaloBlock block() const {
    return {SampleType::u32, size,
            {{}, size},      reinterpret_cast<const std::byte*>(samples.data()),
            size.x,          size.x * size.y};
  }
};

// Regions around random points, cut up by noise here and there.
Labels random_labels(Index3 size, std::uint32_t labels, double noise, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> one(0, 1);
  std::vector<Index3> centres;
  for (std::uint32_t i = 0; i < labels; ++i)
    centres.push_back({static_cast<std::int64_t>(one(random) * static_cast<double>(size.x)),
                       static_cast<std::int64_t>(one(random) * static_cast<double>(size.y)),
                       static_cast<std::int64_t>(one(random) * static_cast<double>(size.z))});
  Labels out{size, {}};
  each_index(size, [&](Index3 at) {
    std::uint32_t nearest = 0;
    std::int64_t best = INT64_MAX;
    for (std::uint32_t i = 0; i < labels; ++i) {
      const Index3 d = centres[i] - at;
      const std::int64_t squared = d.x * d.x + d.y * d.y + d.z * d.z;
      if (squared < best) best = squared, nearest = i;
    }
    if (one(random) < noise) nearest = static_cast<std::uint32_t>(random() % labels);
    out.samples.push_back(nearest);
  });
  return out;
}

template <class T>
std::string bytes_of(const std::vector<T>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

std::string bytes_of(const BrickOctree& brick) {
  std::ostringstream all;
  for (const std::string& part :
       {bytes_of(brick.vertices), bytes_of(brick.polygons), bytes_of(brick.blocks),
        bytes_of(brick.ghost.cells), bytes_of(brick.ghost.vertices),
        bytes_of(std::vector<RootRecord>{brick.root})})
    all << part.size() << ':' << part;
  const BrickCounts& c = brick.counts;
  all << c.active_cells << ' ' << c.crossing_edges << ' ' << c.vertices;
  for (const std::uint64_t leaves : c.by_level.leaves) all << ' ' << leaves;
  for (const float error : c.by_level.errors) all << ' ' << error;
  return all.str();
}

struct Windows {
  BrickScratch scratch, whole_scratch;  // apart: what is left of one label meets the next
  LabelExtents extents;
  BrickOctree part, whole;
};

void expect_same(const Labels& volume, const BrickPlace& place, const ContourParameters& common,
                 Windows& w) {
  const HaloBlock block = volume.block();
  std::uint32_t labels = 0;
  for (const std::uint32_t label : volume.samples) labels = std::max(labels, label + 1);
  const auto span = w.extents.find(block, place, labels, labels);
  const std::set<std::uint32_t> found(span.begin(), span.end());
  ContourParameters parameters = common;
  for (std::uint32_t label = 0; label < labels; ++label) {
    parameters.surface.label = label;
    build_brick(block, place, parameters, w.whole_scratch, w.whole);
    if (!found.contains(label)) {
      EXPECT_EQ(w.whole.root.state, NodeState::outside) << "label " << label;
      continue;
    }
    build_brick(block, place, w.extents.samples(label), parameters, w.scratch, w.part);
    ASSERT_EQ(bytes_of(w.part), bytes_of(w.whole)) << "label " << label;
    if (w.extents.everywhere(label)) {
      EXPECT_EQ(w.whole.root.state, NodeState::inside);
    }
  }
}

TEST(LabelExtents, GiveTheBytesOfTheWholeBrick) {
  Windows w;
  unsigned seed = 1;
  for (const Index3 size : {Index3{70, 66, 65}, Index3{40, 31, 64}, Index3{5, 90, 20}})
    for (const double noise : {0.0, 0.05, 1.0})
      for (const int level : {4, 6})
        for (const Border border : {Border::closed, Border::open}) {
          if (noise == 1.0 && border == Border::open) continue;
          ContourParameters parameters;
          parameters.spacing = {0.8, 1, 1.5};
          parameters.surface.border = border;
          const Labels volume = random_labels(size, noise == 1.0 ? 5 : 23, noise, seed++);
          const std::int64_t side = std::int64_t{1} << level;
          for (std::int64_t z = 0; z * side <= size.z; z += 1 + z % 2)
            for (std::int64_t y = 0; y * side <= size.y; y += 2)
              for (std::int64_t x = 0; x * side <= size.x; ++x)
                expect_same(volume, {Index3{x, y, z} * side, level}, parameters, w);
        }
}

RC_GTEST_PROP(LabelExtents, GiveTheBytesOfTheWholeBrickOfAnyNoise, (const unsigned seed)) {
  std::mt19937 random(seed);
  const auto below = [&](int end) {
    return static_cast<int>(random() % static_cast<unsigned>(end));
  };
  const Index3 size{1 + below(40), 1 + below(40), 1 + below(40)};
  const Labels volume =
      random_labels(size, static_cast<std::uint32_t>(2 + below(12)), below(11) / 10.0, seed);
  Windows w;
  const int level = 4 + below(2);
  const std::int64_t side = std::int64_t{1} << level;
  each_index(Index3{size.x / side + 1, size.y / side + 1, size.z / side + 1}, [&](Index3 at) {
    expect_same(volume, {at * side, level}, {}, w);
  });
  RC_ASSERT(!::testing::Test::HasFailure());
}

TEST(LabelExtents, AreOfTheCellsAlone) {
  // A brick of 16 cells has corners at the samples -1 .. 15; signs look one sample further.
  constexpr std::size_t side = 40;
  Labels volume{{side, side, side}, std::vector<std::uint32_t>(side * side * side, 1)};
  const auto at = [&](std::size_t x) -> std::uint32_t& {
    return volume.samples[(8 * side + 8) * side + x];
  };
  at(16) = 2;
  at(15) = 3;
  LabelExtents extents;
  const auto found = extents.find(volume.block(), {{}, 4}, 4, 0);
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[0], 1u);
  EXPECT_EQ(extents.samples(1), (Box3{{0, 0, 0}, {17, 17, 17}}));
  EXPECT_FALSE(extents.everywhere(1));
  EXPECT_EQ(found[1], 3u);
  EXPECT_EQ(extents.samples(3), (Box3{{15, 8, 8}, {16, 9, 9}}));
  const auto inner = extents.find(volume.block(), {{16, 16, 16}, 4}, 4, 0);
  ASSERT_EQ(inner.size(), 1u);
  EXPECT_TRUE(extents.everywhere(1));
  EXPECT_TRUE(extents.find(volume.block(), {{16, 16, 16}, 4}, 4, 1).empty());
}

}  // namespace
}  // namespace voxweld
