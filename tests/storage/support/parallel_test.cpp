#include "storage/support/parallel.h"

#include <gtest/gtest.h>

#include <atomic>
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

}  // namespace
}  // namespace voxweld::testing
