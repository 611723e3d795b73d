// What is made of a brick of which only the side is known, against what its samples give.
#include <gtest/gtest.h>

#include "stages/build/build_brick.h"
#include "tests/stages/cluster_volumes.h"
#include "tests/stages/same_octree.h"

namespace voxweld {
namespace {

using testing::MemoryVolume;

constexpr int level = 4;
constexpr std::int64_t side = std::int64_t{1} << level;

// One sample, `odd`, is on the other side.
BrickOctree of_samples(Index3 brick, Inside inside, Index3 odd) {
  const auto volume = MemoryVolume::made<std::uint8_t>(
      splat(3 * side), SampleType::u8, [&](Index3 s) { return s == odd ? 0 : 200; });
  const HaloBlock block{volume.type,           volume.size,   {{}, volume.size},
                        volume.samples.data(), volume.size.x, volume.size.x * volume.size.y};
  ContourParameters parameters = testing::by_sheets(0.1);
  parameters.surface.isovalue = {100};
  parameters.surface.inside = inside;
  BrickScratch scratch;
  BrickOctree out;
  build_brick(block, {brick * side, level}, parameters, scratch, out);
  return out;
}
BrickOctree of_side(Index3 brick, NodeState state) {
  BrickOctree out;
  out.vertices.resize(7);  // what an earlier brick left
  out.counts.active_cells = 3;
  build_whole_brick({brick * side, level}, state, out);
  return out;
}

TEST(WholeBrick, IsWhatItsSamplesGive) {
  // Cells of brick 1 touch the samples side - 1 to 2 side - 1. Those beside them are read for its signs.
  const Index3 beside = {side - 2, side, side}, far = splat(0);
  for (const Index3 odd : {far, beside}) {
    testing::expect_same(of_side(splat(1), NodeState::inside),
                         of_samples(splat(1), Inside::above, odd));
    testing::expect_same(of_side(splat(1), NodeState::outside),
                         of_samples(splat(1), Inside::below, odd));
  }
  // The ring is outside as well.
  testing::expect_same(of_side({}, NodeState::outside), of_samples({}, Inside::below, splat(40)));
  EXPECT_EQ(of_samples(splat(1), Inside::above, {side - 1, side, side}).root.state,
            NodeState::split);
}

}  // namespace
}  // namespace voxweld
