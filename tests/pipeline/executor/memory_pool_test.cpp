#include "pipeline/executor/memory_pool.h"

#include <gtest/gtest.h>

#include <atomic>
#include <random>
#include <thread>
#include <vector>

namespace voxweld {
namespace {

void wait_until(const std::function<bool()>& holds) {
  for (int i = 0; i < 2000 && !holds(); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  ASSERT_TRUE(holds());
}

TEST(MemoryPool, GivesWhatItHasAndNoMore) {
  MemoryPool pool(100);
  EXPECT_TRUE(pool.try_take(60));
  EXPECT_FALSE(pool.try_take(41));
  EXPECT_TRUE(pool.try_take(40));
  pool.give_back(60);
  EXPECT_TRUE(pool.try_take(1));
  EXPECT_EQ(pool.peak(), 100U);
}

TEST(MemoryPool, WhoWaitsIsServedBeforeWhoComesLater) {
  MemoryPool pool(100);
  ASSERT_TRUE(pool.try_take(60));
  std::atomic<bool> served = false;
  std::jthread large([&] {
    pool.take(90, nullptr);
    served = true;
  });
  wait_until([&] { return pool.wanted(); });
  EXPECT_FALSE(pool.try_take(10));  // it would fit, and keep the one who waits waiting
  EXPECT_FALSE(served);
  pool.give_back(60);
  wait_until([&] { return served.load(); });
  EXPECT_FALSE(pool.wanted());
  EXPECT_EQ(pool.waits(), 1U);
}

TEST(MemoryPool, WhoAsksForMoreThanThereIsIsServedAlone) {
  MemoryPool pool(100);
  ASSERT_TRUE(pool.try_take(10));
  std::atomic<bool> served = false;
  std::jthread huge([&] {
    pool.take(1000, nullptr);
    served = true;
  });
  wait_until([&] { return pool.wanted(); });
  EXPECT_FALSE(served);
  pool.give_back(10);
  wait_until([&] { return served.load(); });
  EXPECT_FALSE(pool.try_take(1));
  pool.give_back(1000);
  EXPECT_TRUE(pool.try_take(100));
}

TEST(MemoryPool, AStopEndsTheWaitAndLeavesTheQueue) {
  MemoryPool pool(100);
  InterruptFlag stop;
  ASSERT_TRUE(pool.try_take(100));
  std::atomic<bool> stopped = false;
  std::jthread waiting([&] {
    try {
      pool.take(1, &stop);
    } catch (const Interrupted&) {
      stopped = true;
    }
  });
  wait_until([&] { return pool.wanted(); });
  stop.request();
  wait_until([&] { return stopped.load(); });
  EXPECT_FALSE(pool.wanted());
  pool.give_back(100);
  EXPECT_TRUE(pool.try_take(100));
}

TEST(MemoryShare, GrowsToTheLargestAndIsGivenBackWithItsBuffersWhenSomebodyWaits) {
  const auto pool = std::make_shared<MemoryPool>(100);
  int freed = 0;
  MemoryShare share(pool, nullptr, [&] { ++freed; });
  const MemoryShare::Use use(share);
  share.reserve(30);
  share.reserve(20);
  EXPECT_EQ(share.held(), 30U);
  share.reserve(50);
  EXPECT_EQ(share.held(), 50U);
  share.yield();
  EXPECT_EQ(share.held(), 50U);
  EXPECT_EQ(freed, 0);
  std::jthread other([&] {
    pool->take(80, nullptr);
    pool->give_back(80);
  });
  wait_until([&] { return pool->wanted(); });
  share.yield();
  EXPECT_EQ(share.held(), 0U);
  EXPECT_EQ(freed, 1);
}

TEST(MemoryShare, KeepsItsBuffersBetweenUsesUntilSomebodyNeedsThem) {
  const auto pool = std::make_shared<MemoryPool>(100);
  int freed = 0;
  MemoryShare share(pool, nullptr, [&] { ++freed; });
  const auto use = [&](std::uint64_t bytes) {
    const MemoryShare::Use in_use(share);
    share.reserve(bytes);
    EXPECT_GE(share.held(), bytes);
  };
  use(60);
  EXPECT_TRUE(pool->try_take(40));
  EXPECT_EQ(share.held(), 60U);
  use(60);
  EXPECT_EQ(freed, 0);
  pool->give_back(40);
  pool->take(50, nullptr);  // would wait for ever if the share were not taken back
  EXPECT_EQ(freed, 1);
  EXPECT_EQ(share.held(), 0U);
  pool->give_back(50);
  use(100);
  EXPECT_TRUE(pool->try_take(1));
  EXPECT_EQ(freed, 2);
  const MemoryShare::Use in_use(share);
  share.reserve(99);
  EXPECT_FALSE(pool->try_take(1)) << "nobody may take what is in use";
}

TEST(MemoryShare, InAHurryTakesWhatIsFreeAndWaitsForNothing) {
  const auto pool = std::make_shared<MemoryPool>(100);
  int freed = 0;
  MemoryShare share(pool, nullptr, [&] { ++freed; });
  const MemoryShare::Use use(share);
  ASSERT_TRUE(pool->try_take(50));
  {
    const MemoryShare::Hurry hurry(share);
    share.reserve(50);
    EXPECT_THROW(share.reserve(51), NoMemoryLeft);
    EXPECT_EQ(share.held(), 50U);
  }
  EXPECT_EQ(freed, 0);
  int asked = 0;
  const MemoryShare::BeforeWaiting before(share, [&] {
    ++asked;
    pool->give_back(50);
  });
  share.reserve(51);  // would wait for ever if nothing were given back
  EXPECT_EQ(asked, 1);
  EXPECT_EQ(share.held(), 51U);
}

TEST(MemoryLoan, IsGivenOrNot) {
  MemoryPool pool(100);
  const auto loan = MemoryLoan::attempt(pool, 60);
  ASSERT_TRUE(loan);
  EXPECT_FALSE(MemoryLoan::attempt(pool, 41));
  EXPECT_TRUE(MemoryLoan::attempt(pool, 40));  // given back at once
  EXPECT_TRUE(pool.try_take(40));
}

// Workers with bricks of any size: never more than the budget, and nobody waits for ever.
TEST(MemoryShare, WorkersOfAnySizeEndWithinTheBudget) {
  constexpr std::uint64_t budget = 1000;
  const auto pool = std::make_shared<MemoryPool>(budget);
  std::atomic<std::uint64_t> live = 0, most = 0, done = 0;
  {
    std::vector<std::jthread> workers;
    for (unsigned w = 0; w < 6; ++w)
      workers.emplace_back([&, w] {
        std::mt19937 random(w);
        std::uint64_t buffers = 0;
        MemoryShare share(pool, nullptr, [&] {
          live -= buffers;
          buffers = 0;
        });
        std::optional<MemoryShare::Use> use;
        for (int brick = 0; brick < 2000; ++brick) {
          if (brick % 20 == 0) {
            use.reset();
            use.emplace(share);
          }
          const std::uint64_t bytes = random() % 50 == 0 ? budget : random() % 400;
          share.reserve(bytes);
          if (bytes > buffers) {
            const std::uint64_t now = live += bytes - buffers;
            buffers = bytes;
            std::uint64_t before = most;
            while (now > before && !most.compare_exchange_weak(before, now)) {
            }
          }
          ++done;
          share.yield();
        }
      });
  }
  EXPECT_EQ(done, 12000U);
  EXPECT_LE(most, budget);
  EXPECT_GT(most, budget / 2);
  EXPECT_TRUE(pool->try_take(budget));
}

}  // namespace
}  // namespace voxweld
