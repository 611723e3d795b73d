#include "pipeline/executor/resources.h"

#include <fcntl.h>
#include <malloc.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <ctime>
#include <fstream>
#include <limits>
#include <string>

namespace voxweld {
namespace {

constexpr std::uint64_t least_mapped_block = std::uint64_t{256} << 10;

// A figure of /proc/self/status, in bytes; 0 where there is none.
std::uint64_t status_bytes(const std::string& field) {
  std::ifstream status("/proc/self/status");
  std::string name;
  while (status >> name) {
    if (name == field) {
      std::uint64_t kibibytes = 0;
      return status >> kibibytes ? kibibytes * 1024 : 0;
    }
    status.ignore(std::numeric_limits<std::streamsize>::max(), '\n');
  }
  return 0;
}

std::uint64_t peak_since_reset() {
  if (const std::uint64_t peak = status_bytes("VmHWM:"); peak != 0) return peak;
  struct rusage usage {};
  if (getrusage(RUSAGE_SELF, &usage) != 0) return 0;
  return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
}

// Keeps the peak so far for whoever waits for this process (a shell's `time`, a workflow's accounting).
// They are told the larger of its own peak, which is lost with a reset, and of its children's. A child of
// vfork() has this process's memory, so also its peak; this one ends at once.
bool keep_peak() {
  // NOLINTNEXTLINE(clang-analyzer-security.insecureAPI.vfork): it does nothing but end
  const pid_t child = vfork();
  if (child == 0) _exit(0);
  if (child < 0) return false;
  pid_t ended = -1;
  do ended = waitpid(child, nullptr, 0);
  while (ended < 0 && errno == EINTR);
  return ended == child;
}

// Sets the peak to what is resident now. False where that is not permitted or not heeded.
bool reset_peak() {
  if (!keep_peak()) return false;
  const int fd = ::open("/proc/self/clear_refs", O_WRONLY | O_CLOEXEC);
  if (fd < 0) return false;
  const bool written = ::write(fd, "5", 1) == 1;
  ::close(fd);
  return written && status_bytes("VmHWM:") != 0;
}

double seconds_of(clockid_t clock) {
  struct timespec now {};
  clock_gettime(clock, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace

std::uint64_t resident_bytes() {
  return status_bytes("VmRSS:");
}

StageMeter::StageMeter()
    : wall_start_s_(seconds_of(CLOCK_MONOTONIC)),
      cpu_start_s_(seconds_of(CLOCK_PROCESS_CPUTIME_ID)),
      peak_was_reset_(reset_peak()) {}

StageFigures StageMeter::read() const {
  StageFigures figures;
  figures.wall_s = seconds_of(CLOCK_MONOTONIC) - wall_start_s_;
  figures.cpu_s = seconds_of(CLOCK_PROCESS_CPUTIME_ID) - cpu_start_s_;
  figures.peak_resident = peak_since_reset();
  figures.peak_is_of_stage = peak_was_reset_;
  return figures;
}

void tune_allocator(int threads) {
#ifdef __GLIBC__
  // A threshold that is set stays: by itself glibc raises it to the largest block freed so far, up
  // to 32 MiB, and blocks below it are kept.
  mallopt(M_MMAP_THRESHOLD, static_cast<int>(least_mapped_block));
  mallopt(M_TRIM_THRESHOLD, static_cast<int>(4 * least_mapped_block));
  // More than workers: where others that live as long have taken one each, two workers share one, and
  // wait for each other.
  mallopt(M_ARENA_MAX, std::max(threads, 1) + 4);
#else
  static_cast<void>(threads);
#endif
}

std::uint64_t mapped_block_bytes(std::uint64_t memory, int threads) {
  const std::uint64_t share = memory / (512 * static_cast<std::uint64_t>(std::max(threads, 1)));
  return std::clamp<std::uint64_t>(share, least_mapped_block, 16 * least_mapped_block);
}

void keep_freed_memory(std::uint64_t memory, int threads) {
#ifdef __GLIBC__
  const std::uint64_t block = mapped_block_bytes(memory, threads);
  mallopt(M_MMAP_THRESHOLD, static_cast<int>(block));
  mallopt(M_TRIM_THRESHOLD, static_cast<int>(block == least_mapped_block ? 4 * block : 16 * block));
#else
  static_cast<void>(memory);
  static_cast<void>(threads);
#endif
}

void release_free_memory() {
#ifdef __GLIBC__
  malloc_trim(0);
#endif
}

}  // namespace voxweld
