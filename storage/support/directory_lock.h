// One writer of a directory at a time, on any file system that many machines share: a file in it
// says who writes, and its time of modification, moved on as long as the writer lives, that it
// still does. No lock of the kernel's is asked for: those of some shared file systems hold on one
// machine only.
#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <thread>

namespace voxweld {

struct LockHolder {
  std::string owner;  // what the lock was taken for
  std::string host;
  long process = 0;
};

struct LockOptions {
  // A lock whose time has not moved for `expiry` is of a writer that is no more.
  std::chrono::milliseconds beat{5000}, expiry{60000};
  // While somebody else holds it, called now and then with who that is; throws to give up.
  std::function<void(const LockHolder&)> waiting;
};

class DirectoryLock {
 public:
  static constexpr const char* name = "voxweld.lock";

  // Waits for the lock of the directory, which is made where it is missing. The lock of a process
  // of this machine that is no more is taken over at once. StorageError when the directory cannot
  // be written.
  DirectoryLock(const std::filesystem::path& directory, const std::string& owner,
                LockOptions options);
  // Gives it back, and takes away a directory that the lock has made and that is empty.
  ~DirectoryLock();
  DirectoryLock(const DirectoryLock&) = delete;
  DirectoryLock& operator=(const DirectoryLock&) = delete;

  // Throws StorageError where it is no longer ours: the process was halted for longer than a lock
  // lasts, and somebody else has taken over.
  void check() const;

 private:
  std::filesystem::path directory_, path_;
  std::string text_;  // of the file; no other lock has the same
  bool made_directory_ = false;
  std::jthread beating_;
};

// Who holds the lock of a directory now; nothing where nobody does.
std::optional<LockHolder> lock_holder(const std::filesystem::path& directory,
                                      const LockOptions& options = {});

}  // namespace voxweld
