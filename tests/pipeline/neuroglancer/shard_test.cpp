#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pipeline/neuroglancer/object_store.h"
#include "pipeline/neuroglancer/world.h"
#include "tests/pipeline/cli/workplace.h"

namespace voxweld::testing {
namespace {

using ::testing::ElementsAre;

TEST(Sharding, HasSixtyFourObjectsToAMinishard) {
  const auto bits = [](std::uint64_t objects) {
    const Sharding s = sharding_for(objects);
    return std::pair(s.minishard_bits, s.shard_bits);
  };
  EXPECT_EQ(bits(1), std::pair(0, 0));
  EXPECT_EQ(bits(64), std::pair(0, 0));
  EXPECT_EQ(bits(65), std::pair(1, 0));
  EXPECT_EQ(bits(std::uint64_t{64} * 512), std::pair(9, 0));
  EXPECT_EQ(bits(std::uint64_t{64} * 512 + 1), std::pair(9, 1));
}

TEST(Sharding, OrdersObjectsByWhereTheyLie) {
  const Sharding sharding{1, 1};
  const std::vector<std::uint64_t> ids{0, 1, 2, 3, 4, 6};
  EXPECT_THAT(order_in_shards(ids, sharding), ElementsAre(0, 4, 1, 2, 5, 3));
}

// The bytes of a shard, by hand: two objects of one minishard, the other one empty.
TEST(Sharding, WritesWhatTheSpecificationSays) {
  const TempDirectory folder;
  const auto store = shard_store(folder.path(), {1, 5});
  const auto bytes = [](const std::string& text) { return std::as_bytes(std::span(text)); };
  const std::string a = "aaa", m = "mm", b = "bbbbb", n = "nnnn";
  store->append(67, bytes(a));  // 0b1000011: minishard 1, shard 1
  store->finish(67, bytes(m));
  store->append(131, bytes(b));
  store->finish(131, bytes(n));
  store->close();
  const std::string shard = read_bytes(folder / "01.shard");
  ASSERT_EQ(shard.size(), 32u + 14 + 48);
  std::vector<std::uint64_t> ends(4), index(6);
  std::memcpy(ends.data(), shard.data(), 32);
  std::memcpy(index.data(), shard.data() + 32 + 14, 48);
  EXPECT_THAT(ends, ElementsAre(14, 14, 14, 62));
  EXPECT_EQ(shard.substr(32, 14), "aaammbbbbbnnnn");
  EXPECT_THAT(index, ElementsAre(67, 64, 3, 5, 2, 4));
}

TEST(World, IsInNanometres) {
  VolumeGeometry frame;
  frame.unit = "mm";
  frame.origin = {1, -2, 0.5};
  frame.direction = {Vec3{0, 1, 0}, Vec3{1, 0, 0}, Vec3{0, 0, 1}};
  EXPECT_EQ(nanometre_matrix(frame),
            (std::array<double, 12>{0, 1e6, 0, 1e6, 1e6, 0, 0, -2e6, 0, 0, 1e6, 5e5}));
  EXPECT_TRUE(is_mirrored(frame));
  frame.unit = "nm";
  EXPECT_EQ(nanometre_matrix(frame)[1], 1);
  frame.unit = "";  // not known: as nanometres
  EXPECT_EQ(nanometre_matrix(frame)[1], 1);
}

}  // namespace
}  // namespace voxweld::testing
