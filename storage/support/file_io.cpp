#include "storage/support/file_io.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <charconv>
#include <csignal>
#include <cstring>
#include <optional>
#include <random>
#include <system_error>
#include <utility>

#include "storage/support/error.h"
#include "storage/support/host.h"

namespace voxweld {

// "<name>.tmp-<host>-<process>-<16 hexadecimal digits>": the digits begin at random in each process and
// count on from there. A random number a name would take as long as the rest of opening a small file.
std::string temporary_name(const std::filesystem::path& path) {
  static std::atomic<std::uint64_t> next = [] {
    std::random_device device;
    return (static_cast<std::uint64_t>(device()) << 32) | device();
  }();
  return fmt::format("{}.tmp-{}-{}-{:016x}", path.string(), host_name(), getpid(), next++);
}

namespace {

constexpr std::size_t buffer_bytes = std::size_t{1} << 18;

// What such a name says.
struct Temporary {
  std::string file, host;
  pid_t process = 0;
};

std::optional<Temporary> read_temporary_name(const std::string& name) {
  constexpr std::size_t random_digits = 16;
  const std::string mark = ".tmp-";
  const std::size_t at = name.rfind(mark);
  const std::size_t random = name.rfind('-');
  if (at == std::string::npos || name.size() != random + 1 + random_digits ||
      name.find_first_not_of("0123456789abcdef", random + 1) != std::string::npos)
    return std::nullopt;
  const std::size_t host = at + mark.size();
  const std::size_t dash = name.rfind('-', random - 1);  // a host's name may have some too
  if (dash < host || dash == std::string::npos) return std::nullopt;
  Temporary temporary{name.substr(0, at), name.substr(host, dash - host)};
  const char* const end = name.data() + random;
  const auto parsed = std::from_chars(name.data() + dash + 1, end, temporary.process);
  if (parsed.ec != std::errc() || parsed.ptr != end || temporary.process <= 0) return std::nullopt;
  return temporary;
}

// Whether `name` is such a name, of a process of this host that is no more.
bool is_stale_temporary(const std::string& name, const std::string& host) {
  const auto temporary = read_temporary_name(name);
  return temporary && temporary->host == host && kill(temporary->process, 0) != 0 && errno == ESRCH;
}

// Those that `unwanted` holds of.
template <class Iterator, class Test>
void remove_of(const std::filesystem::path& folder, const Test& unwanted) {
  // Another process may clear the same folder: what is gone already is no failure.
  std::error_code error;
  for (Iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    if (!unwanted(entry->path())) continue;
    std::error_code ignored;
    std::filesystem::remove(entry->path(), ignored);
  }
}

template <class Test>
void remove_files(const std::filesystem::path& folder, bool recursive, const Test& unwanted) {
  if (recursive)
    remove_of<std::filesystem::recursive_directory_iterator>(folder, unwanted);
  else
    remove_of<std::filesystem::directory_iterator>(folder, unwanted);
}

std::int64_t nanoseconds(const timespec& time) {
  return std::int64_t{time.tv_sec} * 1'000'000'000 + time.tv_nsec;
}

FileState state_of(const struct stat& status) {
  return {static_cast<std::uint64_t>(status.st_size), nanoseconds(status.st_mtim),
          nanoseconds(status.st_ctim)};
}

}  // namespace

std::size_t read_at(int file, std::uint64_t offset, std::span<std::byte> out,
                    const std::string& path) {
  std::size_t done = 0;
  while (done < out.size()) {
    const ssize_t got =
        pread(file, out.data() + done, out.size() - done, static_cast<off_t>(offset + done));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) throw_errno("read", path, errno);
    if (got == 0) break;
    done += static_cast<std::size_t>(got);
  }
  return done;
}

void write_at(int file, std::uint64_t offset, std::span<const std::byte> data,
              const std::string& path) {
  std::size_t done = 0;
  while (done < data.size()) {
    const ssize_t put =
        pwrite(file, data.data() + done, data.size() - done, static_cast<off_t>(offset + done));
    if (put < 0 && errno == EINTR) continue;
    if (put < 0) throw_errno("write", path, errno);
    done += static_cast<std::size_t>(put);
  }
}

std::optional<FileState> file_state(const std::filesystem::path& path) {
  struct stat status {};
  if (stat(path.c_str(), &status) != 0) return std::nullopt;
  return state_of(status);
}

namespace {

// What the user has to mend is said as such; a missing file has its own ways.
[[noreturn]] void throw_unreadable(const std::string& path, int error) {
  if (error == EACCES || error == EPERM)
    throw InputError(fmt::format(
        "{}: cannot be read: {}: change the permissions of the file, or of the folders it is in",
        path, std::strerror(error)));
  if (error == ELOOP)
    throw InputError(
        fmt::format("{}: cannot be read: its symbolic links form a loop: correct them", path));
  throw_errno("open", path, error);
}

}  // namespace

ReadFile::ReadFile(const std::filesystem::path& path) : path_(path.string()) {
  // To open a FIFO would wait for a writer otherwise; of regular files it makes no difference.
  fd_ = open(path_.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (fd_ < 0) throw_unreadable(path_, errno);
  struct stat status {};
  if (fstat(fd_, &status) != 0) {
    const int error = errno;
    close(fd_);
    throw_errno("stat", path_, error);
  }
  if (!S_ISREG(status.st_mode)) {
    close(fd_);
    throw InputError(path_ + ": not a regular file: name one that is");
  }
  state_ = state_of(status);
}

ReadFile::~ReadFile() {
  if (fd_ >= 0) close(fd_);
}

ReadFile::ReadFile(ReadFile&& other) noexcept
    : path_(std::move(other.path_)), fd_(std::exchange(other.fd_, -1)), state_(other.state_) {}

ReadFile& ReadFile::operator=(ReadFile&& other) noexcept {
  std::swap(path_, other.path_);
  std::swap(fd_, other.fd_);
  std::swap(state_, other.state_);
  return *this;
}

void ReadFile::read(std::uint64_t offset, std::span<std::byte> out) const {
  if (const std::size_t got = read_at(fd_, offset, out, path_); got < out.size())
    throw FormatError(
        fmt::format("{}: truncated: {} bytes wanted at offset {}, the file ends at {}", path_,
                    out.size(), offset, offset + got));
}

AtomicFile::AtomicFile(const std::filesystem::path& path)
    : final_path_(path), temporary_(temporary_name(path)) {
  if (path.has_parent_path()) make_directories(path.parent_path());
  fd_ = open(temporary_.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  if (fd_ < 0) throw_errno("create", temporary_, errno);
  buffer_.reserve(buffer_bytes);
}

AtomicFile::~AtomicFile() {
  if (fd_ >= 0) {
    close(fd_);
    unlink(temporary_.c_str());
  }
}

void AtomicFile::flush() {
  voxweld::write_at(fd_, size_ - buffer_.size(), buffer_, final_path_.string());
  buffer_.clear();
}

void AtomicFile::append(std::span<const std::byte> data) {
  if (buffer_.size() + data.size() > buffer_bytes) flush();
  if (data.size() >= buffer_bytes)
    voxweld::write_at(fd_, size_, data, final_path_.string());
  else
    buffer_.insert(buffer_.end(), data.begin(), data.end());
  size_ += data.size();
}

void AtomicFile::write_at(std::uint64_t offset, std::span<const std::byte> data) {
  if (!buffer_.empty()) flush();
  voxweld::write_at(fd_, offset, data, final_path_.string());
}

void AtomicFile::extend(std::uint64_t size) {
  flush();
  if (ftruncate(fd_, static_cast<off_t>(size)) != 0)
    throw_errno("extend", final_path_.string(), errno);
  size_ = size;
}

void AtomicFile::commit(Durability durability) {
  flush();
  if (durability == Durability::fsync && fsync(fd_) != 0)
    throw_errno("fsync", final_path_.string(), errno);
  const int fd = std::exchange(fd_, -1);
  if (close(fd) != 0) {
    const int error = errno;
    unlink(temporary_.c_str());
    throw_errno("close", final_path_.string(), error);
  }
  if (rename(temporary_.c_str(), final_path_.c_str()) != 0) {
    const int error = errno;
    unlink(temporary_.c_str());
    throw_errno("rename into place", final_path_.string(), error);
  }
}

void remove_stale_temporaries(const std::filesystem::path& folder, bool recursive) {
  remove_files(folder, recursive, [host = host_name()](const std::filesystem::path& path) {
    return is_stale_temporary(path.filename().string(), host);
  });
}

void remove_needless_temporaries(const std::filesystem::path& folder, bool recursive) {
  remove_files(folder, recursive, [](const std::filesystem::path& path) {
    const auto temporary = read_temporary_name(path.filename().string());
    std::error_code ignored;
    return temporary && std::filesystem::exists(path.parent_path() / temporary->file, ignored);
  });
}

std::vector<std::byte> read_whole_file(const std::filesystem::path& path) {
  const ReadFile file(path);
  std::vector<std::byte> data(file.size());
  file.read(0, data);
  return data;
}

std::string read_text_file(const std::filesystem::path& path) {
  const ReadFile file(path);
  std::string text(file.size(), '\0');
  file.read(0, std::as_writable_bytes(std::span(text)));
  return text;
}

void write_whole_file(const std::filesystem::path& path, std::span<const std::byte> data,
                      Durability durability) {
  AtomicFile file(path);
  file.append(data);
  file.commit(durability);
}

void make_directories(const std::filesystem::path& path) {
  std::error_code error;
  std::filesystem::create_directories(path, error);
  if (error) throw_errno("create directory", path.string(), error.value());
}

void remove_file(const std::filesystem::path& path) {
  std::error_code error;
  std::filesystem::remove(path, error);
  if (error) throw_errno("remove", path.string(), error.value());
}

}  // namespace voxweld
