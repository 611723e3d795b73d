// Runs that helpers build: each once, in any order, and given out in order.
#include "pipeline/build/runs_ahead.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <atomic>
#include <chrono>
#include <thread>

#include "storage/support/error.h"

namespace voxweld {
namespace {

constexpr int threads = 4;

std::vector<BrickRow> some_rows(std::int64_t count) {
  std::vector<BrickRow> rows;
  for (std::int64_t i = 0; i < count; ++i) rows.push_back({{i, 0, 0}, 1, {}});
  return rows;
}

std::unique_ptr<RunPieces> pieces_of(const BrickRow& row) {
  std::this_thread::sleep_for(std::chrono::milliseconds(2));
  auto pieces = std::make_unique<RunPieces>();
  pieces->built.first = row.first;
  return pieces;
}

// f(worker) as a stage's only unit, on one of `threads` threads.
template <class F>
void as_only_unit(const F& f) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
  tbb::task_arena arena(threads);
  RunOptions options;
  options.threads = threads;
  const std::atomic<int> busy{1};
  arena.execute([&] { f(WorkerContext(0, options, &busy)); });
}

struct Counts {
  std::vector<int> own, ahead;  // how often each run was built, by whom
};

struct NoNote {
  void operator()(RunsAhead&, std::size_t) const {}
};

// Takes all runs; `own` is called for those that the shard's thread is to build, `before` before each.
template <class Build, class Own, class Before = NoNote>
Counts take_all(const std::vector<BrickRow>& rows, const Build& build, const Own& own,
                const Before& before = {}) {
  Counts counts{std::vector<int>(rows.size()), std::vector<int>(rows.size())};
  as_only_unit([&](const WorkerContext& worker) {
    RunsAhead ahead(rows, worker, build, build);
    for (std::size_t i = 0; i < rows.size(); ++i) {
      before(ahead, i);
      if (const auto pieces = ahead.take(i)) {
        EXPECT_EQ(pieces->built.first, rows[i].first);
        ++counts.ahead[i];
      } else {
        own(ahead, i);
        ++counts.own[i];
      }
    }
  });
  for (std::size_t i = 0; i < rows.size(); ++i) EXPECT_EQ(counts.own[i] + counts.ahead[i], 1) << i;
  return counts;
}

int sum(const std::vector<int>& counts) {
  int all = 0;
  for (const int count : counts) all += count;
  return all;
}

TEST(RunsAhead, GivesEachRunOnceAndInOrder) {
  const auto rows = some_rows(200);
  std::atomic<int> built{0};
  const auto build = [&](const BrickRow& row) {
    ++built;
    return pieces_of(row);
  };
  const Counts counts = take_all(rows, build, [&](RunsAhead&, std::size_t i) { build(rows[i]); });
  EXPECT_EQ(built, 200);
  EXPECT_GT(sum(counts.ahead), 20);  // the others helped
}

TEST(RunsAhead, StaysNearTheShardsOwnThread) {
  const auto rows = some_rows(100);
  std::atomic<std::int64_t> at{0}, furthest{0};
  const auto build = [&](const BrickRow& row) {
    const std::int64_t before = row.first.x - at;
    std::int64_t most = furthest;
    while (before > most && !furthest.compare_exchange_weak(most, before)) continue;
    return pieces_of(row);
  };
  take_all(
      rows, build, [&](RunsAhead&, std::size_t r) { pieces_of(rows[r]); },
      [&](RunsAhead&, std::size_t r) { at = static_cast<std::int64_t>(r); });
  EXPECT_GT(furthest, 0);
  EXPECT_LE(furthest, 2 * (threads - 1) + 1);  // `at` may be one behind
}

// What fails is told where its turn is, whoever built it, and all before it is there.
TEST(RunsAhead, TellsAFailureInItsTurn) {
  const auto rows = some_rows(50);
  const auto build = [&](const BrickRow& row) -> std::unique_ptr<RunPieces> {
    if (row.first.x >= 20) throw StorageError("the disk is on fire");
    return pieces_of(row);
  };
  std::size_t taken = 0;
  as_only_unit([&](const WorkerContext& worker) {
    RunsAhead ahead(rows, worker, build, build);
    EXPECT_THROW(
        {
          for (; taken < rows.size(); ++taken)
            if (!ahead.take(taken)) build(rows[taken]);
        },
        StorageError);
  });
  EXPECT_EQ(taken, 20U);
}

TEST(RunsAhead, LeavesToTheShardsOwnThreadWhatNeedsMemory) {
  const auto rows = some_rows(60);
  std::atomic<int> tries{0};
  const auto build = [&](const BrickRow&) -> std::unique_ptr<RunPieces> {
    ++tries;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    throw NoMemoryLeft();
  };
  const Counts counts =
      take_all(rows, build, [&](RunsAhead&, std::size_t i) { pieces_of(rows[i]); });
  EXPECT_EQ(sum(counts.ahead), 0);
  EXPECT_GE(tries, 1);
  EXPECT_LE(tries, threads);  // and gives up then
}

TEST(RunsAhead, WithoutHelpersIsTheShardsOwnWork) {
  const auto rows = some_rows(20);
  const auto none = [](const BrickRow&) { return std::unique_ptr<RunPieces>(); };
  const Counts counts =
      take_all(rows, none, [&](RunsAhead&, std::size_t i) { pieces_of(rows[i]); });
  EXPECT_EQ(sum(counts.own), 20);
}

// Neither do they where they may not, nor is anything built ahead meanwhile.
TEST(RunsAhead, WhereNoneMayHelpNothingIsBuiltAhead) {
  const auto rows = some_rows(20);
  as_only_unit([&](const WorkerContext& worker) {
    RunsAhead ahead(rows, worker, {}, [](const BrickRow&) -> std::unique_ptr<RunPieces> {
      ADD_FAILURE() << "built ahead";
      return nullptr;
    });
    for (std::size_t i = 0; i < rows.size(); ++i) EXPECT_EQ(ahead.take(i), nullptr);
  });
}

// What was built ahead is forgotten, and its memory is given back, before the one who asks for it
// waits.
TEST(RunsAhead, StopsAndForgets) {
  const auto rows = some_rows(60);
  MemoryPool pool(1000);
  const auto build = [&](const BrickRow& row) {
    auto pieces = pieces_of(row);
    pieces->loan = MemoryLoan::attempt(pool, 10);
    return pieces;
  };
  const Counts counts = take_all(
      rows, build, [&](RunsAhead&, std::size_t r) { pieces_of(rows[r]); },
      [&](RunsAhead& ahead, std::size_t r) {
        if (r < 30) return;
        ahead.stop();
        EXPECT_TRUE(MemoryLoan::attempt(pool, 1000));
      });
  EXPECT_GE(sum(counts.own), 30);
  EXPECT_TRUE(MemoryLoan::attempt(pool, 1000));
}

}  // namespace
}  // namespace voxweld
