#include "pipeline/executor/interrupt.h"

#include <unistd.h>

#include <array>
#include <cassert>
#include <cerrno>
#include <csignal>
#include <string_view>

namespace voxweld {
namespace {

constexpr std::array<int, 2> handled_signals = {SIGINT, SIGTERM};

// What the handler may touch: lock-free atomics only.
std::atomic<InterruptFlag*> active_flag{nullptr};
std::atomic<bool> interrupt_seen{false};
std::array<struct sigaction, handled_signals.size()> previous_actions;

void say(std::string_view text) {
  // Nothing can be done about a message that cannot be shown.
  [[maybe_unused]] const ssize_t ignored = ::write(STDERR_FILENO, text.data(), text.size());
}

extern "C" void on_stop_signal(int signal) {
  const int saved_errno = errno;
  if (InterruptFlag* flag = active_flag.load()) flag->request();
  if (signal == SIGINT) {
    if (interrupt_seen.exchange(true)) ::_exit(128 + SIGINT);
    say("\nstopping; Ctrl-C again stops at once\n");
  }
  errno = saved_errno;
}

}  // namespace

InterruptScope::InterruptScope(InterruptFlag& flag) {
  [[maybe_unused]] InterruptFlag* before = active_flag.exchange(&flag);
  assert(before == nullptr && "one InterruptScope at a time");
  interrupt_seen = false;
  struct sigaction action {};
  action.sa_handler = on_stop_signal;
  sigemptyset(&action.sa_mask);
  // Reads and writes under way go on; workers look at the flag between them.
  action.sa_flags = SA_RESTART;
  for (std::size_t i = 0; i < handled_signals.size(); ++i) {
    if (sigaction(handled_signals[i], &action, &previous_actions[i]) != 0)
      throw_errno("install", "the handler of stop signals", errno);
  }
}

InterruptScope::~InterruptScope() {
  for (std::size_t i = 0; i < handled_signals.size(); ++i)
    sigaction(handled_signals[i], &previous_actions[i], nullptr);
  active_flag = nullptr;
}

}  // namespace voxweld
