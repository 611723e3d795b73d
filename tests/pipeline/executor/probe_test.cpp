#include "pipeline/executor/probe.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <mutex>
#include <stdexcept>
#include <string>
#include <thread>

namespace voxweld {
namespace {

TEST(Probe, AsksEachOnce) {
  for (const std::size_t count : {0, 1, 3, 4, 5, 63, 64, 1000}) {
    std::vector<std::atomic<int>> asked(count);
    probe_all(count, [&](std::size_t i) { ++asked[i]; });
    for (const auto& times : asked) EXPECT_EQ(times, 1);
  }
}

TEST(Probe, WaitsForManyAnswersAtOnce) {
  std::atomic<std::size_t> under_way{0}, most{0};
  probe_all(256, [&](std::size_t) {
    const std::size_t now = ++under_way;
    for (std::size_t seen = most; seen < now && !most.compare_exchange_weak(seen, now);) {
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
    --under_way;
  });
  EXPECT_GT(most, 4u);
  EXPECT_LE(most, probes_at_once);
}

// A run with few ranges asks some twenty times: threads would take longer than the answers.
TEST(Probe, StartsNoThreadsForQuickAnswers) {
  const auto caller = std::this_thread::get_id();
  std::size_t others = 0, least = 1000;
  for (int turn = 0; turn < 50; ++turn) {  // the machine may be busy in one of them
    others = 0;
    std::mutex mutex;
    probe_all(64, [&](std::size_t) {
      const std::scoped_lock lock(mutex);
      others += std::this_thread::get_id() != caller ? 1 : 0;
    });
    least = std::min(least, others);
  }
  EXPECT_EQ(least, 0u);
}

TEST(Probe, ThrowsTheErrorOfTheLowest) {
  for (int turn = 0; turn < 20; ++turn) {
    try {
      probe_all(500, [](std::size_t i) {
        if (i == 37 || i % 100 == 99) throw std::runtime_error(std::to_string(i));
      });
      FAIL() << "nothing was thrown";
    } catch (const std::runtime_error& error) {
      EXPECT_STREQ(error.what(), "37");
    }
  }
}

TEST(Probe, NamesThoseThatHoldInOrder) {
  const auto which = probe_which(100, [](std::size_t i) { return i % 33 == 0; });
  EXPECT_EQ(which, (std::vector<std::size_t>{0, 33, 66, 99}));
}

TEST(Probe, UsesInOrderWhatItReadsAhead) {
  std::vector<std::size_t> order;
  probe_in_order<std::string>(
      100, 16, [](std::size_t i) { return std::to_string(i * i); },
      [&](std::size_t i, std::string&& value) {
        EXPECT_EQ(value, std::to_string(i * i));
        order.push_back(i);
      });
  ASSERT_EQ(order.size(), 100u);
  for (std::size_t i = 0; i < order.size(); ++i) EXPECT_EQ(order[i], i);
}

}  // namespace
}  // namespace voxweld
