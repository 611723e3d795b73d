#include "storage/dicom/work_apart.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <exception>

#include "storage/support/error.h"

namespace voxweld {
namespace {

constexpr rlim_t cpu_seconds = 300;

// What both processes see.
struct Shared {
  std::int32_t done;  // 1 once `out` is filled
  char why[200];
};
constexpr std::size_t out_at = 256;
static_assert(sizeof(Shared) <= out_at);

class SharedMemory {
 public:
  explicit SharedMemory(std::size_t bytes) : bytes_(bytes) {
    data_ = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (data_ == MAP_FAILED) throw StorageError("cannot map memory to decode a frame", errno);
  }
  ~SharedMemory() { munmap(data_, bytes_); }
  SharedMemory(const SharedMemory&) = delete;
  SharedMemory& operator=(const SharedMemory&) = delete;

  Shared& shared() const { return *static_cast<Shared*>(data_); }
  std::byte* out() const { return static_cast<std::byte*>(data_) + out_at; }

 private:
  void* data_;
  std::size_t bytes_;
};

void say(Shared& shared, const char* text) {
  std::strncpy(shared.why, text, sizeof shared.why - 1);
}

// Ends without the destructors and buffers that are the parent's.
[[noreturn]] void work_and_end(Shared& shared, std::span<std::byte> out,
                               const std::function<bool(std::span<std::byte>)>& work) {
  const rlimit no_core{0, 0}, cpu{cpu_seconds, cpu_seconds};
  setrlimit(RLIMIT_CORE, &no_core);
  setrlimit(RLIMIT_CPU, &cpu);
  if (const int nowhere = open("/dev/null", O_WRONLY | O_CLOEXEC); nowhere >= 0) {
    dup2(nowhere, STDOUT_FILENO);
    dup2(nowhere, STDERR_FILENO);
  }
  try {
    shared.done = work(out) ? 1 : 0;
  } catch (const std::exception& failure) {
    say(shared, failure.what());
  } catch (...) {
  }
  _exit(0);
}

}  // namespace

bool work_apart(std::span<std::byte> out, const std::function<bool(std::span<std::byte>)>& work,
                std::string& why) {
  const SharedMemory memory(out_at + out.size());
  const pid_t child = fork();
  if (child < 0) throw StorageError("cannot start a process to decode a frame", errno);
  if (child == 0) work_and_end(memory.shared(), {memory.out(), out.size()}, work);
  int status = 0;
  pid_t ended = 0;
  do ended = waitpid(child, &status, 0);
  while (ended < 0 && errno == EINTR);
  if (memory.shared().done == 1) {
    std::memcpy(out.data(), memory.out(), out.size());
    return true;
  }
  memory.shared().why[sizeof(Shared::why) - 1] = '\0';
  why = memory.shared().why;
  std::ranges::replace_if(
      why, [](char c) { return c < ' ' || c > '~'; }, ' ');
  if (why.empty() && ended == child && WIFSIGNALED(status))
    why = fmt::format("its decoder ended by signal {}", WTERMSIG(status));
  return false;
}

}  // namespace voxweld
