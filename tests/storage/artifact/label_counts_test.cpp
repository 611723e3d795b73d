#include "storage/artifact/label_counts.h"

#include <gtest/gtest.h>

#include "storage/support/error.h"
#include "storage/support/file_io.h"
#include "tests/support/temp_directory.h"

namespace voxweld {
namespace {

using testing::TempDirectory;

class LabelCountsFile : public ::testing::Test {
 protected:
  void write(std::uint64_t labels) {
    LabelCountsWriter out(path(), {1, 2});
    for (std::uint64_t i = 0; i < labels; ++i) out.add(count(i));
    out.commit(77);
  }
  static LabelCount count(std::uint64_t i) { return {3 * i, i + 1, {1, 2, 3}, {4, 5, 6}}; }
  std::filesystem::path path() const { return directory_ / "labels.all"; }
  static std::vector<LabelCount> all(const LabelCounts& counts) {
    std::vector<LabelCount> read;
    counts.each([&](const LabelCount& one) {
      read.push_back(one);
      return true;
    });
    return read;
  }

 private:
  const TempDirectory directory_;
};

TEST_F(LabelCountsFile, ReadsBack) {
  for (const std::uint64_t labels : {0, 1, 16384, 40000}) {
    write(labels);
    const LabelCounts counts(path());
    EXPECT_EQ(counts.key(), (Hash128{1, 2}));
    EXPECT_EQ(counts.summary(), (LabelSummary{labels, labels * (labels + 1) / 2, 77,
                                              labels == 0 ? 0 : 3 * labels - 3}));
    const auto read = all(counts);
    ASSERT_EQ(read.size(), labels);
    for (std::uint64_t i = 0; i < labels; ++i) ASSERT_EQ(read[i], count(i));
  }
  std::uint64_t seen = 0;
  LabelCounts(path()).each([&](const LabelCount&) { return ++seen < 5; });
  EXPECT_EQ(seen, 5U);
}

TEST_F(LabelCountsFile, DamageIsFound) {
  write(50);
  const auto whole = read_whole_file(path());
  for (std::size_t i = 0; i < whole.size(); i += 13) {
    auto damaged = whole;
    damaged[i] ^= std::byte{4};
    write_whole_file(path(), damaged, Durability::rename_only);
    EXPECT_THROW(all(LabelCounts(path())), DamagedArtifact) << i;
    write_whole_file(path(), std::span(whole).first(i), Durability::rename_only);
    EXPECT_THROW(all(LabelCounts(path())), DamagedArtifact) << i;
  }
}

}  // namespace
}  // namespace voxweld
