#include "stages/build/active_cells.h"

#include <gtest/gtest.h>

#include <cstring>
#include <vector>

namespace voxweld {
namespace {

SurfaceParameters below_1() {
  SurfaceParameters surface;
  surface.isovalue = 1;
  surface.inside = Inside::below;
  return surface;
}

// A volume of as many samples a side as the brick at its origin, and its ring, have points.
class Samples {
 public:
  Samples(std::int64_t side, float value)
      : side_(side), values_(static_cast<std::size_t>(side * side * side), value) {}
  float& at(std::int64_t x, std::int64_t y, std::int64_t z) {
    return values_[static_cast<std::size_t>((z * side_ + y) * side_ + x)];
  }
  HaloBlock block() const {
    return {SampleType::f32,
            splat(side_),
            {{}, splat(side_)},
            reinterpret_cast<const std::byte*>(values_.data()),
            side_,
            side_ * side_};
  }

 private:
  std::int64_t side_;
  std::vector<float> values_;
};

std::size_t count_one_by_one(const SignGrid& signs, int side) {
  std::size_t count = 0;
  for (int z = 0; z < side; ++z)
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x) {
        const CellSigns cell = signs.cell(x, y, z);
        count += cell != 0 && cell != 255 ? 1 : 0;
      }
  return count;
}

// A brick in the middle: all its points have samples.
void expect_counts(const Samples& samples, int side, bool uniform) {
  SignGrid signs;
  signs.fill(samples.block(), splat(2), side, below_1());
  EXPECT_EQ(signs.is_uniform(), uniform);
  ActiveCells cells;
  EXPECT_EQ(cells.count(signs, side, Box3{{}, splat(side)}), count_one_by_one(signs, side));
}

TEST(ActiveCells, OnePointThatDiffersIsSeenWhereverItLies) {
  for (const int side : {16, 32, 64, 128}) {
    const int points = side + 3;
    for (const float value : {0.0f, 2.0f}) {
      Samples samples(points, value);
      expect_counts(samples, side, true);
      for (const int x : {0, 1, points / 2, points - 2, points - 1})
        for (const int yz : {0, points - 1}) {
          samples.at(x, yz, points - 1 - yz) = 2 - value;
          expect_counts(samples, side, false);
          samples.at(x, yz, points - 1 - yz) = value;
        }
    }
  }
}

TEST(ActiveCells, OfABrickOnOneSideThereAreNoneWhateverWasThereBefore) {
  constexpr int side = 16;
  Samples samples(side + 3, 0);
  samples.at(9, 9, 9) = 2;
  SignGrid signs;
  ActiveCells cells;
  signs.fill(samples.block(), splat(2), side, below_1());
  EXPECT_EQ(cells.count(signs, side, Box3{{}, splat(side)}), 8u);
  EXPECT_GT(cells.most_sheets(signs), 0u);
  samples.at(9, 9, 9) = 0;
  signs.fill(samples.block(), splat(2), side, below_1());
  EXPECT_EQ(cells.count(signs, side, Box3{{}, splat(side)}), 0u);
  EXPECT_EQ(cells.most_sheets(signs), 0u);
}

// The points of the ring are outside.
TEST(ActiveCells, AFullVolumeEndsAtItsRing) {
  const Samples samples(16, 0);
  SignGrid signs;
  signs.fill(samples.block(), {}, 16, below_1());
  EXPECT_FALSE(signs.is_uniform());
  ActiveCells cells;
  EXPECT_EQ(cells.count(signs, 16, Box3{{}, splat(16)}), count_one_by_one(signs, 16));
}

}  // namespace
}  // namespace voxweld
