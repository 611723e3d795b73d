// Programs run as a user runs them, with an eye on time and memory. For programs that run thousands.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace voxweld::testing {

struct ProcessLimits {
  double seconds =
      10;  // of processor time; six times that by the clock, for machines with more to do
  bool ask_first = false;  // at the limit it is interrupted, and ended after as long again
  std::uint64_t memory = std::uint64_t{1} << 30;  // resident bytes; it is ended where it has more
};

struct ProcessEnd {
  int exit_code = -1;  // of one that a signal ended: -1
  int signal = 0;      // that ended it; 0: none
  bool timed_out = false, too_large = false;
  bool asked = false;  // it was interrupted at the limit
  double seconds = 0;
  std::uint64_t peak_memory = 0;  // resident bytes
  std::string out, err;
};

using Variables = std::vector<std::pair<std::string, std::string>>;

// A program that has been started. Its output goes to the files <capture>.out and <capture>.err.
class WatchedProcess {
 public:
  WatchedProcess(const std::vector<std::string>& command, const std::filesystem::path& directory,
                 const std::filesystem::path& capture, const Variables& variables = {});
  ~WatchedProcess();  // ends it
  WatchedProcess(WatchedProcess&& other) noexcept;
  WatchedProcess& operator=(WatchedProcess&&) = delete;
  WatchedProcess(const WatchedProcess&) = delete;
  WatchedProcess& operator=(const WatchedProcess&) = delete;

  void send(int signal) const;
  // Until it has ended, or that much time has gone by: whether it has ended.
  bool wait_for(double seconds);
  ProcessEnd wait(const ProcessLimits& limits = {});

 private:
  std::uint64_t resident_bytes() const;
  double processor_seconds() const;
  bool poll_once(double seconds);

  pid_t process_ = -1;
  int handle_ = -1;
  bool ended_ = false;
  double started_ = 0;
  std::filesystem::path capture_;
  ProcessEnd end_;
};

// Started and waited for.
ProcessEnd run_watched(const std::vector<std::string>& command,
                       const std::filesystem::path& directory, const std::filesystem::path& capture,
                       const ProcessLimits& limits = {}, const Variables& variables = {});

// As one would type it into a shell.
std::string shell_text(const std::vector<std::string>& command);

// What is wrong with how voxweld ended, whatever it was given; empty when nothing is. A check that
// found damage (`finding`) may say so on standard output in place of an error.
std::string complaint_of(const ProcessEnd& end, bool finding);

}  // namespace voxweld::testing
