#include "storage/support/trial.h"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>

namespace voxweld {
namespace {

// No trace of the crash is left, and none of what the program does when it is told to end.
void prepare_child(unsigned most_seconds) {
  const rlimit no_core{0, 0}, time{most_seconds, most_seconds + 1};
  setrlimit(RLIMIT_CORE, &no_core);
  setrlimit(RLIMIT_CPU, &time);
  alarm(10 * most_seconds);  // for the hours of a disk that does not answer
  for (const int signal :
       {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGINT, SIGTERM, SIGHUP, SIGALRM})
    std::signal(signal, SIG_DFL);
  const int nowhere = open("/dev/null", O_WRONLY | O_CLOEXEC);
  if (nowhere >= 0) dup2(nowhere, STDERR_FILENO);
}

}  // namespace

TrialEnd try_in_child(const std::function<void()>& what, unsigned most_seconds) {
  const pid_t child = fork();
  if (child < 0) return TrialEnd::survived;
  if (child == 0) {
    prepare_child(most_seconds);
    try {
      what();
    } catch (...) {  // is thrown again where it counts
    }
    _exit(0);
  }
  int status = 0;
  while (waitpid(child, &status, 0) < 0)
    if (errno != EINTR) return TrialEnd::survived;
  if (WIFEXITED(status)) return WEXITSTATUS(status) == 0 ? TrialEnd::survived : TrialEnd::crashed;
  const int signal = WTERMSIG(status);
  if (signal == SIGXCPU || signal == SIGKILL || signal == SIGALRM) return TrialEnd::out_of_time;
  // The user's own Ctrl-C is for this process to see to.
  if (signal == SIGINT || signal == SIGTERM || signal == SIGHUP) return TrialEnd::survived;
  return TrialEnd::crashed;
}

}  // namespace voxweld
