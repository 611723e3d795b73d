#include "pipeline/executor/memory_budget.h"

#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstring>
#include <limits>

#include "pipeline/executor/resources.h"
#include "storage/support/error.h"

namespace voxweld {
namespace {

constexpr std::uint64_t mebibyte = 1 << 20, gibibyte = 1 << 30;

StageMemory build_needs(std::uint64_t base, std::uint64_t per_unit, std::uint64_t per_worker = 0) {
  return {
      "build",   base, per_unit, "one brick (brick = 256)", "raise run.memory or lower work.brick",
      per_worker};
}

std::string refusal(std::uint64_t budget, const StageMemory& need) {
  try {
    threads_within({budget}, need, 4);
  } catch (const InputError& e) {
    return e.what();
  }
  return {};
}

TEST(MemoryBudget, GivesTheWorkersThatFitBesideTheLargestUnitAndNoMoreThanWanted) {
  const StageMemory need = build_needs(30 * mebibyte, 10 * mebibyte, 50 * mebibyte);
  EXPECT_EQ(threads_within({90 * mebibyte}, need, 8), 1);
  EXPECT_EQ(threads_within({139 * mebibyte}, need, 8), 1);
  EXPECT_EQ(threads_within({140 * mebibyte}, need, 8), 2);
  EXPECT_EQ(threads_within({4096 * mebibyte}, need, 8), 8);
  // Units wait for each other: one that fits is enough for all workers.
  EXPECT_EQ(threads_within({40 * mebibyte}, build_needs(30 * mebibyte, 10 * mebibyte), 8), 8);
}

TEST(MemoryBudget, RefusesNamingAFigureThatWouldDo) {
  EXPECT_EQ(refusal(64 * mebibyte, build_needs(40 * mebibyte, 50 * mebibyte)),
            "run.memory = 64MiB is too small: stage build needs at least 90MiB for one brick "
            "(brick = 256); raise run.memory or lower work.brick");
  const StageMemory odd = build_needs(40 * mebibyte, 50 * mebibyte + 1);
  EXPECT_NE(refusal(90 * mebibyte, odd).find("at least 91MiB"), std::string::npos);
  EXPECT_EQ(refusal(91 * mebibyte, odd), "");
}

TEST(MemoryBudget, RefusesSizesThatOverflow) {
  constexpr std::uint64_t huge = std::numeric_limits<std::uint64_t>::max() - 5;
  EXPECT_NE(refusal(64 * mebibyte, build_needs(huge, huge)), "");
}

TEST(MemoryBudget, WritesBytesExactlyAndForPeople) {
  EXPECT_EQ(exact_bytes(0), "0B");
  EXPECT_EQ(exact_bytes(64 * mebibyte), "64MiB");
  EXPECT_EQ(exact_bytes(3 * gibibyte), "3GiB");
  EXPECT_EQ(exact_bytes(1000000), "1000000B");
  EXPECT_EQ(readable_bytes(512), "512 B");
  EXPECT_EQ(readable_bytes(3.4 * 1024 * 1024 * 1024), "3.4 GiB");
}

// Straight from the system: an allocator, a sanitizer's above all, may keep what is freed.
bool hold_for_a_moment(std::size_t bytes) {
  void* block = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (block == MAP_FAILED) return false;
  std::memset(block, 1, bytes);
  return munmap(block, bytes) == 0;
}

TEST(Resources, PeakSeesAnAllocationAndForgetsItAtTheNextStage) {
  constexpr std::size_t large = 64 * mebibyte;
  const StageMeter first;
  const std::uint64_t before = resident_bytes();
  ASSERT_TRUE(hold_for_a_moment(large));
  const StageFigures figures = first.read();
  if (before == 0) GTEST_SKIP() << "the system does not tell resident sizes";
  EXPECT_GE(figures.peak_resident + mebibyte, before + large);
  EXPECT_GE(figures.wall_s, 0);
  EXPECT_GE(figures.cpu_s, 0);
  const StageMeter second;
  if (second.read().peak_is_of_stage) {
    EXPECT_LT(second.read().peak_resident, figures.peak_resident);
  }
}

TEST(Resources, WhoWaitsForTheProcessIsToldThePeakOfAllItsStages) {
#ifdef __SANITIZE_THREAD__
  GTEST_SKIP() << "the thread sanitizer makes a copy for vfork";
#endif
  constexpr std::size_t large = 256 * mebibyte;
  const std::uint64_t before = resident_bytes();
  const pid_t child = fork();
  if (child == 0) {
    const StageMeter first;
    const bool held = hold_for_a_moment(large);
    const StageMeter second;
    _exit(held && second.read().peak_resident < large + before ? 0 : 1);
  }
  ASSERT_GT(child, 0);
  int status = 0;
  rusage used{};
  ASSERT_EQ(wait4(child, &status, 0, &used), child);
  EXPECT_EQ(status, 0);
  EXPECT_GE(static_cast<std::uint64_t>(used.ru_maxrss) * 1024, large);
}

}  // namespace
}  // namespace voxweld
