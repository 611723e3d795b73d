#include "storage/support/child_process.h"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>

namespace voxweld {
namespace {

// Address space of this process; 0 where the system does not say.
std::uint64_t address_space() {
  unsigned long long pages = 0;
  std::FILE* const file = std::fopen("/proc/self/statm", "re");
  if (file == nullptr) return 0;
  if (std::fscanf(file, "%llu", &pages) != 1) pages = 0;
  std::fclose(file);
  return pages * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
}

void limit_address_space(std::uint64_t more_bytes) {
  const std::uint64_t now = address_space();
  rlimit limit{};
  if (more_bytes == 0 || now == 0 || getrlimit(RLIMIT_AS, &limit) != 0) return;
  limit.rlim_cur = std::min<rlim_t>(limit.rlim_cur, now + more_bytes);
  setrlimit(RLIMIT_AS, &limit);
}

void prepare_child(const ChildRules& rules) {
  const rlimit no_core{0, 0}, time{rules.most_seconds, rules.most_seconds + 1};
  setrlimit(RLIMIT_CORE, &no_core);
  if (rules.most_seconds > 0) {
    setrlimit(RLIMIT_CPU, &time);
    alarm(10 * rules.most_seconds);  // for the hours of a disk that does not answer
  }
  limit_address_space(rules.most_more_bytes);
  for (const int signal : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGALRM})
    std::signal(signal, SIG_DFL);
  if (rules.ends_when_told)
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) std::signal(signal, SIG_DFL);
  if (const int nowhere = open("/dev/null", O_WRONLY | O_CLOEXEC); nowhere >= 0) {
    dup2(nowhere, STDOUT_FILENO);
    dup2(nowhere, STDERR_FILENO);
  }
}

}  // namespace

std::optional<int> start_child(const std::function<void()>& what, const ChildRules& rules) {
  const pid_t child = fork();
  if (child < 0) return std::nullopt;
  if (child > 0) return child;
  prepare_child(rules);
  try {
    what();
  } catch (...) {  // is for the caller to find out
  }
  _exit(0);  // without the destructors and buffers that are the parent's
}

int wait_for_child(int child) {
  int status = 0;
  while (waitpid(child, &status, 0) < 0)
    if (errno != EINTR) return 0;
  return status;
}

std::optional<int> run_in_child(const std::function<void()>& what, const ChildRules& rules) {
  const std::optional<int> child = start_child(what, rules);
  if (!child) return std::nullopt;
  return wait_for_child(*child);
}

TrialEnd trial_end(int status) {
  if (WIFEXITED(status)) return WEXITSTATUS(status) == 0 ? TrialEnd::survived : TrialEnd::crashed;
  const int signal = WTERMSIG(status);
  if (signal == SIGXCPU || signal == SIGKILL || signal == SIGALRM) return TrialEnd::out_of_time;
  // The user's own Ctrl-C is for this process to see to.
  if (signal == SIGINT || signal == SIGTERM || signal == SIGHUP) return TrialEnd::survived;
  return TrialEnd::crashed;
}

TrialEnd try_in_child(const std::function<void()>& what, unsigned most_seconds) {
  return trial_end(
      run_in_child(what, {.most_seconds = most_seconds, .ends_when_told = true}).value_or(0));
}

}  // namespace voxweld
