#include "storage/support/child_process.h"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>

namespace voxweld {
namespace {

void prepare_child(const ChildRules& rules) {
  const rlimit no_core{0, 0}, time{rules.most_seconds, rules.most_seconds + 1};
  setrlimit(RLIMIT_CORE, &no_core);
  setrlimit(RLIMIT_CPU, &time);
  alarm(10 * rules.most_seconds);  // for the hours of a disk that does not answer
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

std::optional<int> run_in_child(const std::function<void()>& what, const ChildRules& rules) {
  const pid_t child = fork();
  if (child < 0) return std::nullopt;
  if (child == 0) {
    prepare_child(rules);
    try {
      what();
    } catch (...) {  // is for the caller to find out
    }
    _exit(0);  // without the destructors and buffers that are the parent's
  }
  int status = 0;
  while (waitpid(child, &status, 0) < 0)
    if (errno != EINTR) return 0;
  return status;
}

TrialEnd try_in_child(const std::function<void()>& what, unsigned most_seconds) {
  const int status =
      run_in_child(what, {.most_seconds = most_seconds, .ends_when_told = true}).value_or(0);
  if (WIFEXITED(status)) return WEXITSTATUS(status) == 0 ? TrialEnd::survived : TrialEnd::crashed;
  const int signal = WTERMSIG(status);
  if (signal == SIGXCPU || signal == SIGKILL || signal == SIGALRM) return TrialEnd::out_of_time;
  // The user's own Ctrl-C is for this process to see to.
  if (signal == SIGINT || signal == SIGTERM || signal == SIGHUP) return TrialEnd::survived;
  return TrialEnd::crashed;
}

}  // namespace voxweld
