#include "storage/support/directory_lock.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <condition_variable>
#include <csignal>
#include <mutex>
#include <random>
#include <sstream>

#include "storage/support/error.h"
#include "storage/support/file_io.h"
#include "storage/support/host.h"

namespace voxweld {
namespace {

namespace fs = std::filesystem;

// Three lines: who, where, and what makes it one of a kind.
std::string lock_text(const std::string& owner) {
  std::random_device device;
  const auto random = (static_cast<std::uint64_t>(device()) << 32) | device();
  return fmt::format("{}\n{} {}\n{:016x}\n", owner, getpid(), host_name(), random);
}

// Empty where there is none.
std::string read_text(const fs::path& path) {
  try {
    return read_text_file(path);
  } catch (const Error&) {
    return {};
  }
}

LockHolder holder_of(const std::string& text) {
  LockHolder holder;
  std::istringstream in(text);
  std::getline(in, holder.owner);
  in >> holder.process >> holder.host;
  return holder;
}

// The file system's own time, which may be another than this machine's.
std::int64_t time_there(const fs::path& directory) {
  const fs::path probe = temporary_name(directory / "time");
  write_whole_file(probe, {}, Durability::rename_only);
  const auto state = file_state(probe);
  std::error_code ignored;
  fs::remove(probe, ignored);
  return state ? state->mtime_ns : 0;
}

// Whether the one who wrote it is no more.
bool is_left_behind(const fs::path& path, const std::string& text, const LockOptions& options) {
  const LockHolder holder = holder_of(text);
  if (holder.host == host_name() && holder.process > 0 &&
      kill(static_cast<pid_t>(holder.process), 0) != 0 && errno == ESRCH)
    return true;
  const auto state = file_state(path);
  if (!state) return false;  // given back meanwhile
  const auto expiry = std::chrono::duration_cast<std::chrono::nanoseconds>(options.expiry).count();
  return time_there(path.parent_path()) - state->mtime_ns > expiry;
}

// Only where there is none.
bool place(const fs::path& path, const std::string& text) {
  make_directories(path.parent_path());
  const int file = open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  if (file < 0 && errno == EEXIST) return false;
  if (file < 0 && errno == ENOENT) return false;  // its directory went with another's lock
  if (file < 0) throw_errno("create", path.string(), errno);
  const ssize_t written = write(file, text.data(), text.size());
  const int error = errno;
  close(file);
  if (written == static_cast<ssize_t>(text.size())) return true;
  unlink(path.c_str());
  throw_errno("write", path.string(), written < 0 ? error : ENOSPC);
}

// Only the one whose rename comes first takes it away. Should it be another by then, of somebody
// who was quicker, that goes back.
void remove_left_behind(const fs::path& path, const std::string& text) {
  const fs::path aside = temporary_name(path);
  if (rename(path.c_str(), aside.c_str()) != 0) return;
  if (read_text(aside) == text)
    unlink(aside.c_str());
  else
    rename(aside.c_str(), path.c_str());
}

void keep_beating(const std::stop_token& stop, const fs::path& path, const std::string& text,
                  std::chrono::milliseconds beat) {
  std::mutex mutex;
  std::condition_variable_any ended;
  std::unique_lock lock(mutex);
  while (!ended.wait_for(lock, stop, beat, [&] { return stop.stop_requested(); })) {
    if (read_text(path) != text) return;
    utimensat(AT_FDCWD, path.c_str(), nullptr, 0);
  }
}

}  // namespace

DirectoryLock::DirectoryLock(const fs::path& directory, const std::string& owner,
                             LockOptions options)
    : directory_(directory), path_(directory / name), text_(lock_text(owner)) {
  constexpr std::chrono::milliseconds between_looks{100};
  std::error_code error;
  made_directory_ = !fs::exists(directory_, error);
  while (!place(path_, text_)) {
    const std::string there = read_text(path_);
    if (!fs::exists(path_, error)) continue;  // given back meanwhile
    if (is_left_behind(path_, there, options)) {
      remove_left_behind(path_, there);
      continue;
    }
    // It may be about to be written.
    const LockHolder holder = holder_of(there);
    if (options.waiting && !holder.host.empty()) options.waiting(holder);
    std::this_thread::sleep_for(between_looks);
  }
  beating_ = std::jthread([path = path_, text = text_, beat = options.beat](std::stop_token stop) {
    keep_beating(stop, path, text, beat);
  });
}

DirectoryLock::~DirectoryLock() {
  beating_.request_stop();
  beating_.join();
  std::error_code ignored;
  if (read_text(path_) == text_) fs::remove(path_, ignored);
  if (made_directory_) rmdir(directory_.c_str());  // fails where there is something in it
}

void DirectoryLock::check() const {
  if (read_text(path_) == text_) return;
  throw StorageError(
      fmt::format("{} is no longer this process's: it stood still for so long that another one has "
                  "taken the directory over; run again",
                  path_.string()));
}

std::optional<LockHolder> lock_holder(const fs::path& directory, const LockOptions& options) {
  const fs::path path = directory / DirectoryLock::name;
  std::error_code error;
  if (!fs::exists(path, error)) return std::nullopt;
  const std::string text = read_text(path);
  const LockHolder holder = holder_of(text);
  if (holder.host.empty() || is_left_behind(path, text, options)) return std::nullopt;
  return holder;
}

}  // namespace voxweld
