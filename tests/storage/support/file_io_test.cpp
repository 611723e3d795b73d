// Temporary files that other processes left behind.
#include "storage/support/file_io.h"

#include <gtest/gtest.h>

#include <fstream>

#include "tests/support/temp_directory.h"

namespace voxweld {
namespace {

TEST(FileIo, RemovesTemporariesOfFilesThatAreInPlace) {
  const testing::TempDirectory directory;
  std::filesystem::create_directory(directory / "sub");
  const auto make = [&](const char* name) { std::ofstream(directory / name) << "x"; };
  const char* const needless = "sub/a.octree.tmp-node-7-123-0123456789abcdef";
  for (const char* name : {"sub/a.octree", needless, "sub/b.octree.tmp-node-7-123-0123456789abcdef",
                           "sub/a.octree.tmp-node-7-x-0123456789abcdef", "sub/a.octree.tmp-old"})
    make(name);
  remove_needless_temporaries(directory.path(), false);
  EXPECT_TRUE(std::filesystem::exists(directory / needless));
  remove_needless_temporaries(directory.path(), true);
  EXPECT_FALSE(std::filesystem::exists(directory / needless));
  EXPECT_TRUE(std::filesystem::exists(directory / "sub/a.octree"));
  EXPECT_TRUE(std::filesystem::exists(directory / "sub/b.octree.tmp-node-7-123-0123456789abcdef"));
  EXPECT_TRUE(std::filesystem::exists(directory / "sub/a.octree.tmp-node-7-x-0123456789abcdef"));
  EXPECT_TRUE(std::filesystem::exists(directory / "sub/a.octree.tmp-old"));
  remove_needless_temporaries(directory / "none", true);
}

}  // namespace
}  // namespace voxweld
