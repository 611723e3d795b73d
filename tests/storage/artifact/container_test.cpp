#include "storage/artifact/container.h"

#include <gtest/gtest.h>

#include <numeric>

#include "storage/support/error.h"
#include "storage/support/file_io.h"
#include "tests/support/temp_directory.h"

namespace voxweld {
namespace {

constexpr std::array<char, 4> kind = {'t', 'e', 's', 't'};

std::vector<std::byte> some_bytes(std::size_t count, int seed) {
  std::vector<std::byte> data(count);
  for (std::size_t i = 0; i < count; ++i)
    data[i] = static_cast<std::byte>(i * 131 + static_cast<std::size_t>(seed) * 17);
  return data;
}

std::filesystem::path write_sample(const testing::TempDirectory& directory) {
  auto path = directory / "a.vx";
  ArtifactWriter writer(path, {kind, 3, {7, 9}});
  writer.section(20, some_bytes(100, 1));
  writer.begin_section(10);
  writer.append(some_bytes(33, 2));
  writer.append(some_bytes(7, 3));
  writer.end_section();
  writer.section(30, {});
  writer.commit();
  return path;
}

void read_all(const std::filesystem::path& path) {
  const ArtifactReader reader(path, kind, 3);
  std::vector<std::byte> data;
  for (const SectionRecord& record : reader.sections()) reader.read(record.name, data);
}

TEST(Container, ReadsBackWhatWasWritten) {
  const testing::TempDirectory directory;
  const ArtifactReader reader(write_sample(directory), kind, 3);
  EXPECT_EQ(reader.key(), (Hash128{7, 9}));
  std::vector<std::byte> data;
  reader.read(20, data);
  EXPECT_EQ(data, some_bytes(100, 1));
  reader.read(10, data);
  auto expected = some_bytes(33, 2);
  const auto tail = some_bytes(7, 3);
  expected.insert(expected.end(), tail.begin(), tail.end());
  EXPECT_EQ(data, expected);
  EXPECT_THROW(reader.read(11, data), DamagedArtifact);
}

TEST(Container, RefusesOtherKindsAndVersions) {
  const testing::TempDirectory directory;
  const auto path = write_sample(directory);
  EXPECT_THROW(ArtifactReader(path, {'t', 'e', 's', 'u'}, 3), DamagedArtifact);
  EXPECT_THROW(ArtifactReader(path, kind, 4), DamagedArtifact);
  EXPECT_THROW(ArtifactReader(directory / "none", kind, 3), StorageError);
}

TEST(Container, RefusesEveryTruncationAndEveryFlip) {
  const testing::TempDirectory directory;
  const auto whole = read_whole_file(write_sample(directory));
  const auto path = directory / "damaged.vx";
  for (std::size_t size = 0; size < whole.size(); ++size) {
    write_whole_file(path, std::span(whole).first(size), Durability::rename_only);
    EXPECT_THROW(read_all(path), DamagedArtifact) << "cut at " << size;
  }
  for (std::size_t at = 0; at < whole.size(); ++at) {
    for (const int bit : {0, 7}) {
      auto flipped = whole;
      flipped[at] ^= static_cast<std::byte>(1 << bit);
      write_whole_file(path, flipped, Durability::rename_only);
      EXPECT_THROW(read_all(path), DamagedArtifact) << "byte " << at;
    }
  }
}

TEST(Container, LeavesNothingWithoutCommit) {
  const testing::TempDirectory directory;
  {
    ArtifactWriter writer(directory / "b.vx", {kind, 1, {}});
    writer.section(1, some_bytes(1000000, 1));
  }
  EXPECT_TRUE(std::filesystem::is_empty(directory.path()));
}

}  // namespace
}  // namespace voxweld
