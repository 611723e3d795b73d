#include "storage/support/bounded_cache.h"

#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <thread>
#include <vector>

namespace voxweld {
namespace {

TEST(BoundedCache, KeepsTheLatest) {
  BoundedCache<int> cache(3);
  int loads = 0;
  const auto get = [&](std::uint64_t key) {
    return *cache.get(key, [&] { return ++loads, std::make_shared<int>(static_cast<int>(key)); });
  };
  for (const std::uint64_t key : {1, 2, 3, 1, 2, 3}) EXPECT_EQ(get(key), static_cast<int>(key));
  EXPECT_EQ(loads, 3);
  get(1);
  get(4);  // 2 was asked for longest ago
  EXPECT_EQ(loads, 4);
  get(1), get(3), get(4);
  EXPECT_EQ(loads, 4);
  get(2);
  EXPECT_EQ(loads, 5);
}

TEST(BoundedCache, WhatIsHeldLivesOn) {
  BoundedCache<int> cache(1);
  const auto one = cache.get(1, [] { return std::make_shared<int>(1); });
  cache.get(2, [] { return std::make_shared<int>(2); });
  EXPECT_EQ(*one, 1);
}

TEST(BoundedCache, OfTwoLoadsOneIsKept) {
  BoundedCache<int> cache(2);
  const auto outer =
      cache.get(7, [&] {  // another is faster; that it gets in shows there is no lock
        cache.get(7, [] { return std::make_shared<int>(1); });
        return std::make_shared<int>(2);
      });
  EXPECT_EQ(*outer, 1);
  cache.get(8, [] { return std::make_shared<int>(8); });
  EXPECT_EQ(*cache.get(7, [] { return std::make_shared<int>(3); }), 1) << "holds 7 once";
}

TEST(BoundedCache, ALoadThatThrowsLeavesNothing) {
  BoundedCache<int> cache(2);
  EXPECT_THROW(cache.get(1, []() -> std::shared_ptr<int> { throw std::runtime_error("no"); }),
               std::runtime_error);
  EXPECT_EQ(*cache.get(1, [] { return std::make_shared<int>(5); }), 5);
}

TEST(BoundedCache, ManyThreads) {
  BoundedCache<std::uint64_t> cache(8);
  std::atomic<int> wrong = 0;
  std::vector<std::thread> threads;
  for (std::uint64_t t = 0; t < 4; ++t)
    threads.emplace_back([&, t] {
      for (std::uint64_t i = 0; i < 20000; ++i) {
        const std::uint64_t key = (i * (t + 3)) % 20;
        if (*cache.get(key, [&] { return std::make_shared<std::uint64_t>(key); }) != key) ++wrong;
      }
    });
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(wrong, 0);
}

}  // namespace
}  // namespace voxweld
