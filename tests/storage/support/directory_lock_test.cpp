#include "storage/support/directory_lock.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <fstream>
#include <optional>

#include "storage/support/error.h"
#include "storage/support/host.h"
#include "tests/support/temp_directory.h"

namespace voxweld {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

LockOptions quick() {
  LockOptions options;
  options.beat = 20ms;
  options.expiry = 400ms;
  return options;
}

class GaveUp : public std::exception {};

LockOptions impatient() {
  LockOptions options = quick();
  options.waiting = [](const LockHolder&) { throw GaveUp(); };
  return options;
}

void write_lock(const fs::path& directory, const std::string& host, long process) {
  fs::create_directories(directory);
  std::ofstream(directory / DirectoryLock::name) << "b.toml\n" << process << " " << host << "\n0\n";
}

TEST(DirectoryLock, SaysWhoHoldsIt) {
  const testing::TempDirectory folder;
  EXPECT_FALSE(lock_holder(folder.path()));
  const DirectoryLock lock(folder.path(), "a.toml", quick());
  const auto holder = lock_holder(folder.path());
  ASSERT_TRUE(holder);
  EXPECT_EQ(holder->owner, "a.toml");
  EXPECT_EQ(holder->host, host_name());
  EXPECT_EQ(holder->process, getpid());
  EXPECT_NO_THROW(lock.check());
}

TEST(DirectoryLock, IsOfOneAtATime) {
  const testing::TempDirectory folder;
  std::atomic<int> holding = 0, most = 0, turns = 0;
  {
    std::vector<std::jthread> writers;
    for (int w = 0; w < 4; ++w)
      writers.emplace_back([&] {
        for (int i = 0; i < 5; ++i) {
          const DirectoryLock lock(folder.path(), "a.toml", quick());
          most = std::max(most.load(), ++holding);
          std::this_thread::sleep_for(1ms);
          --holding;
          ++turns;
        }
      });
  }
  EXPECT_EQ(most, 1);
  EXPECT_EQ(turns, 20);
}

TEST(DirectoryLock, LastsAsLongAsItsHolder) {
  const testing::TempDirectory folder;
  std::optional<DirectoryLock> lock(std::in_place, folder.path(), "a.toml", quick());
  std::this_thread::sleep_for(800ms);  // twice what it lasts without a beat
  EXPECT_THROW(DirectoryLock(folder.path(), "b.toml", impatient()), GaveUp);
  EXPECT_NO_THROW(lock->check());
  lock.reset();
  EXPECT_FALSE(lock_holder(folder.path()));
  EXPECT_NO_THROW(DirectoryLock(folder.path(), "b.toml", impatient()));
}

TEST(DirectoryLock, OfADeadProcessIsTakenOverAtOnce) {
  const testing::TempDirectory folder;
  const pid_t child = fork();
  if (child == 0) _exit(0);
  ASSERT_EQ(waitpid(child, nullptr, 0), child);
  write_lock(folder.path(), host_name(), child);
  LockOptions options = impatient();
  options.expiry = 1h;
  EXPECT_NO_THROW(DirectoryLock(folder.path(), "a.toml", options));
}

TEST(DirectoryLock, OfAnotherMachineIsTakenOverWhenItsTimeStandsStill) {
  const testing::TempDirectory folder;
  write_lock(folder.path(), "elsewhere", 1);
  EXPECT_TRUE(lock_holder(folder.path(), quick()));
  EXPECT_THROW(DirectoryLock(folder.path(), "a.toml", impatient()), GaveUp);
  std::this_thread::sleep_for(500ms);
  EXPECT_FALSE(lock_holder(folder.path(), quick()));
  EXPECT_NO_THROW(DirectoryLock(folder.path(), "a.toml", impatient()));
}

TEST(DirectoryLock, LostToAnotherIsFoundOut) {
  const testing::TempDirectory folder;
  const DirectoryLock lock(folder.path(), "a.toml", quick());
  write_lock(folder.path(), "elsewhere", 1);
  EXPECT_THROW(lock.check(), StorageError);
  std::this_thread::sleep_for(500ms);  // nor does it keep the other's alive
  EXPECT_FALSE(lock_holder(folder.path(), quick()));
}

TEST(DirectoryLock, LeavesNothingBehind) {
  const testing::TempDirectory folder;
  const fs::path made = folder.path() / "made", full = folder.path() / "full";
  fs::create_directory(full);
  {
    const DirectoryLock one(made, "a.toml", quick()), other(full, "a.toml", quick());
    EXPECT_TRUE(fs::exists(made));
  }
  EXPECT_FALSE(fs::exists(made));
  EXPECT_TRUE(fs::is_empty(full));
}

}  // namespace
}  // namespace voxweld
