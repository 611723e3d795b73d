#include "pipeline/stage/context.h"

#include <gtest/gtest.h>

#include <cstring>
#include <memory>
#include <vector>

#include "pipeline/executor/resources.h"

namespace voxweld {
namespace {

constexpr std::uint64_t mebibyte = 1 << 20;

// An allocator keeps small blocks that lie below one that is still in use. A stage planned after
// refine was refused for what refine had given back so.
TEST(ProgramBytes, DoNotCountWhatAStageBeforeHasGivenBack) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__) || !defined(__GLIBC__)
  GTEST_SKIP() << "this allocator keeps what is freed";
#endif
  constexpr std::size_t block = 64 << 10, count = 2048;
  const std::uint64_t before = program_bytes();
  std::vector<std::unique_ptr<char[]>> blocks;
  for (std::size_t i = 0; i < count; ++i) {
    blocks.push_back(std::make_unique<char[]>(block));
    std::memset(blocks.back().get(), 1, block);
  }
  const std::unique_ptr<char[]> last = std::move(blocks.back());
  blocks.clear();
  if (resident_bytes() < count * block) GTEST_SKIP() << "nothing was kept";
  // Of a large budget it is no part worth the time.
  EXPECT_GE(program_bytes(std::uint64_t{1} << 40), count * block);
  EXPECT_LE(program_bytes(32 * count * block), before + 16 * mebibyte);
  EXPECT_LE(program_bytes(), before + 16 * mebibyte);
}

// What stays with the allocator is in no plan of a stage: it must be small beside the budget.
TEST(FreedMemory, KeepsAThirtySecondOfTheBudgetAtMost) {
  for (const std::uint64_t memory : {64, 256, 1024, 4096, 262144})
    for (const int threads : {1, 2, 16, 256}) {
      const std::uint64_t block = mapped_block_bytes(memory * mebibyte, threads);
      EXPECT_GE(block, mebibyte / 4);
      EXPECT_LE(block, 4 * mebibyte);
      // Ends of arenas: 16 blocks each, and four of the smallest.
      if (block > mebibyte / 4) {
        EXPECT_LE(16 * block * static_cast<std::uint64_t>(threads), memory * mebibyte / 32);
      }
    }
}

TEST(FreedMemory, LargeBlocksGoBackAtOnce) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__) || !defined(__GLIBC__)
  GTEST_SKIP() << "this allocator keeps what is freed";
#endif
  keep_freed_memory(64 * mebibyte, 2);
  release_free_memory();
  const std::uint64_t before = resident_bytes();
  std::vector<std::unique_ptr<char[]>> blocks;
  for (int i = 0; i < 128; ++i) {
    blocks.push_back(std::make_unique<char[]>(mebibyte));
    std::memset(blocks.back().get(), 1, mebibyte);
  }
  const std::unique_ptr<char[]> last = std::move(blocks.back());
  EXPECT_GE(resident_bytes(), before + 120 * mebibyte);
  blocks.clear();
  EXPECT_LE(resident_bytes(), before + 8 * mebibyte);
}

}  // namespace
}  // namespace voxweld
