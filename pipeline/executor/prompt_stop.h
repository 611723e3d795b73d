// Stopping soon while a library is at work that asks nobody: a decoder, an encoder.
#pragma once

#include <thread>

#include "pipeline/executor/interrupt.h"

namespace voxweld {

// While it lives, a stop that was asked for ends the process within `patience_s`, with the message
// and the exit code of Interrupted, unless the work has ended by then. For work that leaves nothing
// behind: no destructor runs. flag: outlives it.
class PromptStop {
 public:
  explicit PromptStop(const InterruptFlag& flag, double patience_s = 0.5);
  PromptStop(const PromptStop&) = delete;
  PromptStop& operator=(const PromptStop&) = delete;

 private:
  std::jthread watch_;  // its destructor waits for it, so that there is one message
};

}  // namespace voxweld
