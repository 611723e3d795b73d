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
  EXPECT_LE(program_bytes(), before + 16 * mebibyte);
}

}  // namespace
}  // namespace voxweld
