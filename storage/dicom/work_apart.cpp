#include "storage/dicom/work_apart.h"

#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/wait.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <exception>

#include "storage/support/child_process.h"
#include "storage/support/error.h"

namespace voxweld {
namespace {

constexpr unsigned cpu_seconds = 300;

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

}  // namespace

bool work_apart(std::span<std::byte> out, const std::function<bool(std::span<std::byte>)>& work,
                std::string& why) {
  const SharedMemory memory(out_at + out.size());
  Shared& shared = memory.shared();
  const auto apart = [&] {
    try {
      shared.done = work({memory.out(), out.size()}) ? 1 : 0;
    } catch (const std::exception& failure) {
      say(shared, failure.what());
    }
  };
  const auto status = run_in_child(apart, {.most_seconds = cpu_seconds});
  if (!status) throw StorageError("cannot start a process to decode a frame", errno);
  if (shared.done == 1) {
    std::memcpy(out.data(), memory.out(), out.size());
    return true;
  }
  shared.why[sizeof(Shared::why) - 1] = '\0';
  why = shared.why;
  std::ranges::replace_if(
      why, [](char c) { return c < ' ' || c > '~'; }, ' ');
  if (why.empty() && WIFSIGNALED(*status))
    why = fmt::format("its decoder ended by signal {}", WTERMSIG(*status));
  return false;
}

}  // namespace voxweld
