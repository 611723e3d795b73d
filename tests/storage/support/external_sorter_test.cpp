// Records that join where they meet, in memory and in runs on disk. record_sorter_test.cpp has
// those with bytes behind them.
#include "storage/support/external_sorter.h"

#include <gtest/gtest.h>

#include <map>
#include <random>

#include "tests/support/temp_directory.h"

namespace voxweld {
namespace {

struct Count {
  std::uint32_t what = 0, times = 0;
  friend bool operator==(const Count&, const Count&) = default;
};

struct Sums {
  using Head = Count;
  static bool less(const Count& a, const Count& b) { return a.what < b.what; }
  static bool join(Count& into, const Count& next) {
    into.times += next.times;
    return true;
  }
};

struct Pairs {  // that cancel
  using Head = std::uint32_t;
  static bool less(std::uint32_t a, std::uint32_t b) { return a < b; }
  static bool join(std::uint32_t&, std::uint32_t) { return false; }
};

template <class Order>
std::vector<typename Order::Head> drained(ExternalSorter<Order>& sorter) {
  std::vector<typename Order::Head> all;
  typename Order::Head head;
  while (sorter.next(head)) all.push_back(head);
  EXPECT_FALSE(sorter.next(head));
  sorter.clear();
  return all;
}

// From one record a run, so that runs of runs are merged, to all in memory.
constexpr std::uint64_t limits[] = {1, 200, 10000, 1 << 20};

TEST(ExternalSorter, SumsOfEqualRecords) {
  const testing::TempDirectory directory;
  for (const std::uint64_t limit : limits) {
    ExternalSorter<Sums> sorter(directory.path(), limit);
    std::mt19937 random(7);
    for (int turn = 0; turn < 2; ++turn) {  // again after clear()
      std::map<std::uint32_t, std::uint32_t> expected;
      for (int i = 0; i < 9000; ++i) {
        const Count one{static_cast<std::uint32_t>(random() % 3000), 1 + i % 3u};
        sorter.push(one);
        expected[one.what] += one.times;
      }
      EXPECT_EQ(sorter.spilled(), limit < 20000);
      std::vector<Count> counts;
      for (const auto& [what, times] : expected) counts.push_back({what, times});
      EXPECT_EQ(drained(sorter), counts) << limit;
    }
    EXPECT_TRUE(std::filesystem::is_empty(directory.path())) << "the scratch file has no name";
  }
}

TEST(ExternalSorter, PairsCancel) {
  const testing::TempDirectory directory;
  for (const std::uint64_t limit : limits) {
    ExternalSorter<Pairs> sorter(directory.path(), limit);
    std::mt19937 random(11);
    std::map<std::uint32_t, bool> odd;
    for (int i = 0; i < 9000; ++i) {
      const auto value = static_cast<std::uint32_t>(random() % 2000);
      sorter.push(value);
      odd[value] = !odd[value];
    }
    std::vector<std::uint32_t> expected;
    for (const auto& [value, is_odd] : odd)
      if (is_odd) expected.push_back(value);
    EXPECT_EQ(drained(sorter), expected) << limit;
  }
}

// What cancels before memory is full takes no disk, however much of it there is.
TEST(ExternalSorter, WhatCancelsIsNotSpilled) {
  const testing::TempDirectory directory;
  ExternalSorter<Pairs> sorter(directory.path(), 4000);
  for (std::uint32_t i = 0; i < 100000; ++i) sorter.push(i / 2);
  sorter.push(5);
  EXPECT_FALSE(sorter.spilled());
  EXPECT_EQ(drained(sorter), std::vector<std::uint32_t>{5});
}

TEST(ExternalSorter, TakesRunsThatAreInOrder) {
  const testing::TempDirectory directory;
  ExternalSorter<Sums> sorter(directory.path(), 1000);
  std::vector<Count> run;
  for (std::uint32_t i = 0; i < 100; ++i) run.push_back({2 * i, 1});
  for (int i = 0; i < 70; ++i) sorter.push_run(run);
  sorter.push({3, 5});
  EXPECT_TRUE(sorter.spilled());
  const std::vector<Count> all = drained(sorter);
  ASSERT_EQ(all.size(), 101u);
  EXPECT_EQ(all[1], (Count{2, 70}));
  EXPECT_EQ(all[2], (Count{3, 5}));
}

}  // namespace
}  // namespace voxweld
