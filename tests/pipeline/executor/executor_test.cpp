#include "pipeline/executor/executor.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/parallel_for.h>

#include <atomic>
#include <cerrno>
#include <mutex>
#include <numeric>
#include <thread>

#include "pipeline/executor/error_set.h"

namespace voxweld {
namespace {

std::vector<Unit> some_units(std::uint64_t count) {
  std::vector<Unit> units;
  for (std::uint64_t key = 0; key < count; ++key)
    units.push_back({key, "unit " + std::to_string(key), 1.0 + static_cast<double>(key * 7 % 5)});
  return units;
}

RunOptions on_threads(int threads) {
  RunOptions options;
  options.threads = threads;
  return options;
}

std::vector<std::uint64_t> order_of(std::span<const Unit> units, UnitOrder order) {
  std::vector<std::uint64_t> keys;
  RunOptions options = on_threads(1);
  options.order = order;
  LocalExecutor().run_units(
      "build", units, [&](const Unit& unit, WorkerContext&) { keys.push_back(unit.key); }, options);
  return keys;
}

TEST(LocalExecutor, RunsEveryUnitOnceOnAnyNumberOfThreads) {
  const auto units = some_units(200);
  for (const int threads : {1, 2, 8, 500}) {
    std::vector<std::atomic<int>> runs(units.size());
    LocalExecutor().run_units(
        "build", units, [&](const Unit& unit, WorkerContext&) { ++runs[unit.key]; },
        on_threads(threads));
    for (const auto& count : runs) EXPECT_EQ(count, 1);
  }
  LocalExecutor().run_units(
      "build", {}, [](const Unit&, WorkerContext&) { FAIL(); }, on_threads(4));
}

TEST(LocalExecutor, TakesTheLargestFirstOrTheGivenOrder) {
  const std::vector<Unit> units = {{5, "", 1}, {4, "", 3}, {3, "", 1}, {2, "", 9}};
  EXPECT_THAT(order_of(units, UnitOrder::largest_first), testing::ElementsAre(2, 4, 3, 5));
  EXPECT_THAT(order_of(units, UnitOrder::as_given), testing::ElementsAre(5, 4, 3, 2));
}

// Nested parallel work is what tempts a waiting thread to begin another unit.
TEST(LocalExecutor, LendsASlotToOneUnitAtATimeAndNestsNoUnits) {
  constexpr int threads = 4;
  std::vector<std::atomic<bool>> taken(threads);
  std::atomic<int> clashes = 0;
  static thread_local int depth = 0;
  LocalExecutor().run_units(
      "build", some_units(100),
      [&](const Unit&, WorkerContext& context) {
        ASSERT_GE(context.slot(), 0);
        ASSERT_LT(context.slot(), threads);
        if (taken[static_cast<std::size_t>(context.slot())].exchange(true)) ++clashes;
        if (++depth > 1) ++clashes;
#ifndef __SANITIZE_THREAD__  // it does not understand oneTBB
        tbb::parallel_for(0, 64, [](int) { std::this_thread::yield(); });
#endif
        --depth;
        taken[static_cast<std::size_t>(context.slot())] = false;
      },
      on_threads(threads));
  EXPECT_EQ(clashes, 0);
}

// Three of four threads have no unit: what the only one does in parallel may have them.
TEST(LocalExecutor, SaysHowManyThreadsAreToSpare) {
  int spare = -1;
  LocalExecutor().run_units(
      "build", some_units(1), [&](const Unit&, WorkerContext& w) { spare = w.spare_threads(); },
      on_threads(4));
  EXPECT_EQ(spare, 3);
  std::atomic<int> most = 0, last = 0, done = 0;
  LocalExecutor().run_units(
      "build", some_units(40),
      [&](const Unit&, WorkerContext& worker) {
        if (++done <= 36) most = std::max(most.load(), worker.spare_threads());
        last = worker.spare_threads();
      },
      on_threads(4));
  EXPECT_EQ(most, 0);  // there are units for all
  EXPECT_GE(last, 0);
}

std::string failure_on(int threads, const UnitWork& work, std::size_t& finished) {
  std::atomic<std::size_t> done = 0;
  try {
    LocalExecutor().run_units(
        "build", some_units(300),
        [&](const Unit& unit, WorkerContext& context) {
          work(unit, context);
          ++done;
        },
        on_threads(threads));
  } catch (const std::exception& e) {
    finished = done;
    return e.what();
  }
  return {};
}

TEST(LocalExecutor, TellsTheSameErrorsOnOneThreadAndOnMany) {
  const UnitWork work = [](const Unit& unit, WorkerContext&) {
    if (unit.key == 250) throw FormatError("scan.nrrd: truncated");
    if (unit.key % 100 == 3) throw InputError("value out of range");
  };
  const std::string expected =
      "build: 4 units failed:\n"
      "  unit 3, unit 103, unit 203: value out of range\n"
      "  unit 250: scan.nrrd: truncated";
  for (const int threads : {1, 2, 8}) {
    for (int repeat = 0; repeat < 5; ++repeat) {
      std::size_t finished = 0;
      EXPECT_EQ(failure_on(threads, work, finished), expected) << threads << " threads";
      EXPECT_EQ(finished, 296u) << "the others run all the same";
    }
  }
}

TEST(LocalExecutor, RethrowsASingleErrorAsItCame) {
  const auto work = [](const Unit& unit, WorkerContext&) {
    if (unit.key == 7) throw DamagedArtifact("work/octree/7.vx", "checksum is wrong");
  };
  EXPECT_THROW(LocalExecutor().run_units("merge", some_units(20), work, on_threads(4)),
               DamagedArtifact);
}

TEST(LocalExecutor, StartsNoMoreUnitsOnceTheDiskIsFull) {
  std::size_t finished = 0;
  const std::string message = failure_on(
      1,
      [](const Unit& unit, WorkerContext&) {
        if (unit.key == 0) throw_errno("write", "out/1.drc", ENOSPC);
        if (unit.key == 1) throw_errno("write", "out/2.drc", EIO);
      },
      finished);
  // Weights put unit 0 into the last fifth; unit 1 comes earlier and does not end the stage.
  EXPECT_GT(finished, 200u);
  EXPECT_LT(finished, 298u);
  EXPECT_THAT(message, testing::HasSubstr("unit 0: cannot write out/1.drc"));
  EXPECT_THAT(message, testing::HasSubstr("unit 1: cannot write out/2.drc"));
}

TEST(LocalExecutor, StopsBetweenUnitsWhenAsked) {
  for (const int threads : {1, 4}) {
    InterruptFlag flag;
    RunOptions options = on_threads(threads);
    options.interrupt = &flag;
    std::atomic<int> started = 0;
    const auto work = [&](const Unit&, WorkerContext& context) {
      if (++started == 10) flag.request();
      context.check_interrupt();
    };
    EXPECT_THROW(LocalExecutor().run_units("build", some_units(1000), work, options), Interrupted);
    EXPECT_LT(started, 10 + threads);
  }
}

TEST(LocalExecutor, AStopThatLeftNothingUndoneIsNoError) {
  InterruptFlag flag;
  RunOptions options = on_threads(1);
  options.interrupt = &flag;
  const auto work = [&](const Unit& unit, WorkerContext&) {
    if (unit.key == 0) flag.request();
  };
  EXPECT_NO_THROW(LocalExecutor().run_units("build", some_units(1), work, options));
}

}  // namespace
}  // namespace voxweld
