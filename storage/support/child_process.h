// Doing something where it can do no harm: in a child process that is a copy of this one.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>

namespace voxweld {

struct ChildRules {
  unsigned most_seconds = 0;  // of the processor; of the clock ten times as many. 0: any
  // SIGINT, SIGTERM and SIGHUP end it, as any other program; else they mean to it what they mean to
  // this process.
  bool ends_when_told = false;
  // Address space that it may take beyond what this process has; 0: any.
  std::uint64_t most_more_bytes = 0;
};

// Starts `what` in a child and does not wait; its process id, nothing where no child can be made
// (errno). As below.
std::optional<int> start_child(const std::function<void()>& what, const ChildRules& rules);

// Waits for a child to end; its wait status (waitpid(2)).
int wait_for_child(int child);

// Runs `what` in a child; its wait status, nothing where no child can be made (errno).
// What `what` throws, returns or prints is lost. The child leaves no core file.
// Precondition: `what` needs no other thread, and no lock that another thread may hold.
std::optional<int> run_in_child(const std::function<void()>& what, const ChildRules& rules);

enum class TrialEnd : std::uint8_t { survived, crashed, out_of_time };

// What a wait status says.
TrialEnd trial_end(int status);

// The same, to see what becomes of it. Where no child can be made it counts as survived.
TrialEnd try_in_child(const std::function<void()>& what, unsigned most_seconds);

}  // namespace voxweld
