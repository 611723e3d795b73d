// What is kept of a job array: found again as it was written, by whoever comes next.
#include "pipeline/slurm/array_folder.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <set>
#include <thread>

#include "storage/support/error.h"
#include "tests/support/temp_directory.h"

namespace voxweld {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using testing::TempDirectory;
using Lines = std::vector<std::string>;

void write(const fs::path& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

Lines names(const fs::path& parent) {
  Lines names;
  for (const ArrayFolder& folder : ArrayFolder::all(parent))
    names.push_back(folder.path().filename().string());
  return names;
}

TEST(ArrayFolder, HasWhatAnArrayNeeds) {
  const TempDirectory temp;
  const ArrayFolder folder =
      ArrayFolder::create(temp / "build-1" / "more", {"--shards 0"}, "build-7f");
  EXPECT_EQ(folder.path(), temp / "build-1" / "more" / "array-000");
  EXPECT_TRUE(fs::is_directory(folder.logs()));
  EXPECT_TRUE(fs::is_directory(folder.reports()));
  EXPECT_EQ(folder.report_path(12), folder.reports() / "12.json");
  EXPECT_FALSE(folder.job());
  EXPECT_EQ(folder.name(), "build-7f");
}

TEST(ArrayFolder, TasksAreReadAsWritten) {
  const TempDirectory temp;
  const Lines lines = {"--shards 0-63,70", "--shards 64", "", "--tiles 1"};
  EXPECT_EQ(ArrayFolder::create(temp.path(), lines, "x").tasks(), lines);
  EXPECT_EQ(ArrayFolder::create(temp.path(), {}, "x").tasks(), Lines());
  EXPECT_EQ(ArrayFolder(temp / "none").tasks(), Lines());
  // Line N + 1 of the file is what the job script reads.
  std::ifstream file(ArrayFolder::all(temp.path())[0].tasks_path());
  for (const std::string& line : lines) {
    std::string read;
    std::getline(file, read);
    EXPECT_EQ(read, line);
  }
}

TEST(ArrayFolder, ComeInTheOrderTheyWereMade) {
  const TempDirectory temp;
  EXPECT_TRUE(ArrayFolder::all(temp / "none").empty());
  for (const char* number : {"998", "999", "002"})
    fs::create_directory(temp / (std::string("array-") + number));
  ArrayFolder::create(temp.path(), {}, "x");
  ArrayFolder::create(temp.path(), {}, "x");
  EXPECT_THAT(names(temp.path()),
              ElementsAre("array-002", "array-998", "array-999", "array-1000", "array-1001"));
}

TEST(ArrayFolder, ANumberThatWasRemovedIsNotGivenToALaterOne) {
  const TempDirectory temp;
  for (int i = 0; i < 3; ++i) ArrayFolder::create(temp.path(), {}, "x");
  fs::remove_all(temp / "array-000");
  fs::remove_all(temp / "array-001");
  EXPECT_EQ(ArrayFolder::create(temp.path(), {}, "x").path(), temp / "array-003");
}

TEST(ArrayFolder, OthersFilesAreNotTaken) {
  const TempDirectory temp;
  for (const char* name : {"array-", "array-x", "array-1x", "array-001.bak", "array--1", "job"})
    fs::create_directory(temp / name);
  EXPECT_TRUE(ArrayFolder::all(temp.path()).empty());
  EXPECT_EQ(ArrayFolder::create(temp.path(), {}, "x").path(), temp / "array-000");
}

TEST(ArrayFolder, SeveralAtOnceGetOneEach) {
  const TempDirectory temp;
  constexpr int threads = 8, each = 20;
  std::vector<std::vector<fs::path>> made(threads);
  {
    std::vector<std::jthread> drivers;
    for (int t = 0; t < threads; ++t)
      drivers.emplace_back([&, t] {
        for (int i = 0; i < each; ++i)
          made[t].push_back(
              ArrayFolder::create(temp.path(), {fmt::format("--shards {}", t * each + i)}, "x")
                  .path());
      });
  }
  std::set<fs::path> paths;
  for (int t = 0; t < threads; ++t)
    for (int i = 0; i < each; ++i) {
      EXPECT_TRUE(paths.insert(made[t][i]).second) << made[t][i] << " was made twice";
      EXPECT_THAT(ArrayFolder(made[t][i]).tasks(),
                  ElementsAre(fmt::format("--shards {}", t * each + i)));
    }
  EXPECT_EQ(ArrayFolder::all(temp.path()).size(), paths.size());
}

TEST(ArrayFolder, SaysWhatCannotBeMade) {
  const TempDirectory temp;
  write(temp / "file", "");
  EXPECT_THROW(ArrayFolder::create(temp / "file", {}, "x"), StorageError);
}

TEST(ArrayFolder, TheJobIsReadAsWritten) {
  const TempDirectory temp;
  const ArrayFolder folder = ArrayFolder::create(temp.path(), {""}, "x");
  for (const std::int64_t job : {std::int64_t{1}, std::int64_t{4711}, std::int64_t{1} << 40}) {
    folder.set_job(job);
    EXPECT_EQ(folder.job(), job);
  }
}

TEST(ArrayFolder, ADamagedJobIsNone) {
  const TempDirectory temp;
  const ArrayFolder folder = ArrayFolder::create(temp.path(), {""}, "x");
  using namespace std::string_literals;
  for (const std::string& text :
       {""s, "\n"s, "0\n"s, "-5\n"s, "12"s, "12x\n"s, "x12\n"s, "12 13\n"s, "12\n13\n"s, "\0\0\0"s,
        "12\0\n"s, "99999999999999999999\n"s, " 12\n"s}) {
    write(folder.path() / "job", text);
    EXPECT_FALSE(folder.job()) << ::testing::PrintToString(text);
  }
}

TEST(ArrayFolder, ADamagedNameIsNone) {
  const TempDirectory temp;
  const ArrayFolder folder = ArrayFolder::create(temp.path(), {""}, "x");
  for (const char* text : {"", "\n", "x", "x\ny\n"}) {
    write(folder.path() / "name", text);
    EXPECT_EQ(folder.name(), "") << text;
  }
  fs::remove(folder.path() / "name");
  EXPECT_EQ(folder.name(), "");
}

TEST(ArrayFolder, TheLogOfATask) {
  const TempDirectory temp;
  const ArrayFolder folder = ArrayFolder::create(temp.path(), {""}, "x");
  EXPECT_EQ(folder.log_path(17, 3), folder.logs());
  write(folder.logs() / "17_3.log", "it began\n");
  EXPECT_EQ(folder.log_path(17, 3), folder.logs() / "17_3.log");
  EXPECT_EQ(folder.log_path(17, 4), folder.logs());
}

}  // namespace
}  // namespace voxweld
