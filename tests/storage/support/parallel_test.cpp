#include "storage/support/parallel.h"

#include <gtest/gtest.h>

#include <atomic>
#include <mutex>
#include <stdexcept>
#include <vector>

namespace voxweld::testing {
namespace {

TEST(ForEachIndex, CallsEachOnce) {
  for (const std::size_t count : {0, 1, 2, 1000}) {
    std::vector<std::atomic<int>> calls(count);
    for_each_index(count, [&](std::size_t i) { ++calls[i]; });
    for (std::size_t i = 0; i < count; ++i) EXPECT_EQ(calls[i], 1) << i << " of " << count;
  }
}

TEST(ForEachIndex, ThrowsWhatIsThrown) {
  EXPECT_THROW(for_each_index(100,
                              [](std::size_t i) {
                                if (i == 57) throw std::runtime_error("57");
                              }),
               std::runtime_error);
}

// Numbers of several sizes, some larger than what there is.
TEST(ForEachInOrder, KeepsToOrderSlotsAndSize) {
  constexpr std::size_t slots = 3, most = 10;
  for (const std::size_t count : {0, 1, 2, 500}) {
    std::mutex mutex;
    std::vector<bool> worked(count);
    std::vector<std::size_t> of_slot(slots);
    std::size_t next = 0, under_way = 0, taken = 0;
    const auto size = [](std::size_t i) { return i % 7 == 6 ? most + 2 : i % 5; };
    const auto work = [&](std::size_t i, std::size_t slot) {
      {
        const std::scoped_lock lock(mutex);
        ASSERT_LT(slot, slots);
        of_slot[slot] = i;
        taken += size(i);
        EXPECT_LE(++under_way, slots);
        EXPECT_TRUE(taken <= most || under_way == 1) << i;
      }
      for_each_index(3, [](std::size_t) {});
      const std::scoped_lock lock(mutex);
      EXPECT_EQ(of_slot[slot], i);  // nobody else has it meanwhile
      worked[i] = true;
    };
    const auto put = [&](std::size_t i, std::size_t slot) {
      const std::scoped_lock lock(mutex);
      EXPECT_EQ(i, next++);
      EXPECT_TRUE(worked[i]);
      EXPECT_EQ(of_slot[slot], i);
      taken -= size(i);
      --under_way;
    };
    for_each_in_order({count, size, work, put}, slots, most);
    EXPECT_EQ(next, count);
  }
}

TEST(ForEachInOrder, ThrowsWhatIsThrown) {
  std::atomic<std::size_t> puts = 0;
  const auto fails_at = [](std::size_t which) {
    return [=](std::size_t i, std::size_t) {
      if (i == which) throw std::runtime_error("57");
    };
  };
  const auto size = [](std::size_t) -> std::size_t { return 1; };
  EXPECT_THROW(for_each_in_order(
                   {100, size, fails_at(57), [&](std::size_t, std::size_t) { ++puts; }}, 4, 100),
               std::runtime_error);
  EXPECT_LE(puts, 57u);
  EXPECT_THROW(
      for_each_in_order({100, size, [](std::size_t, std::size_t) {}, fails_at(57)}, 4, 100),
      std::runtime_error);
}

}  // namespace
}  // namespace voxweld::testing
