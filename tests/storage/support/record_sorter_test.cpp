#include "storage/support/record_sorter.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "tests/support/temp_directory.h"

namespace voxweld {
namespace {

struct Pushed {
  SortKey key;
  std::vector<std::byte> bytes;
};

// Records of all sizes, many of equal keys.
std::vector<Pushed> random_records(std::size_t count, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<Pushed> records;
  for (std::size_t i = 0; i < count; ++i) {
    Pushed record{{random() % 50, random() % 7}, {}};
    record.bytes.resize(random() % 5 == 0 ? random() % 3000 : random() % 20);
    for (std::byte& b : record.bytes) b = static_cast<std::byte>(random());
    records.push_back(std::move(record));
  }
  return records;
}

void expect_sorted(RecordSorter& sorter, std::vector<Pushed> records) {
  for (const Pushed& record : records) sorter.push(record.key, record.bytes);
  EXPECT_EQ(sorter.size(), records.size());
  std::stable_sort(records.begin(), records.end(),
                   [](const Pushed& a, const Pushed& b) { return a.key < b.key; });
  SortKey key;
  std::vector<std::byte> bytes;
  for (const Pushed& expected : records) {
    ASSERT_TRUE(sorter.next(key, bytes));
    EXPECT_EQ(key, expected.key);
    EXPECT_EQ(bytes, expected.bytes);
  }
  EXPECT_FALSE(sorter.next(key, bytes));
  EXPECT_FALSE(sorter.next(key, bytes));
}

TEST(RecordSorter, SortsWhatFitsAndWhatDoesNot) {
  const testing::TempDirectory directory;
  for (const std::uint64_t limit :
       {std::uint64_t{1}, std::uint64_t{1000}, std::uint64_t{100000}, std::uint64_t{1} << 30}) {
    RecordSorter sorter(directory / "scratch", limit);
    for (unsigned seed = 0; seed < 3; ++seed) {  // again after clear()
      expect_sorted(sorter, random_records(seed == 0 ? 5000 : 700, seed));
      EXPECT_EQ(sorter.spilled(), limit < 1000000);
      sorter.clear();
    }
    expect_sorted(sorter, {});
    sorter.clear();
  }
}

TEST(RecordSorter, LeavesNoFile) {
  const testing::TempDirectory directory;
  RecordSorter sorter(directory.path(), 1000);
  for (const Pushed& record : random_records(700, 1)) sorter.push(record.key, record.bytes);
  ASSERT_TRUE(sorter.spilled());
  EXPECT_TRUE(std::filesystem::is_empty(directory.path()));
}

}  // namespace
}  // namespace voxweld
