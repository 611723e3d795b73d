#include "pipeline/executor/prompt_stop.h"

#include <spdlog/spdlog.h>
#include <unistd.h>

#include <chrono>
#include <condition_variable>
#include <mutex>

namespace voxweld {
namespace {

// Sleeps, but not once the work has ended. Returns whether it has.
bool work_ends_within(std::chrono::duration<double> time, const std::stop_token& ended) {
  std::mutex mutex;
  std::condition_variable_any wake;
  std::unique_lock lock(mutex);
  return wake.wait_for(lock, ended, time, [&] { return ended.stop_requested(); });
}

}  // namespace

PromptStop::PromptStop(const InterruptFlag& flag, double patience_s)
    : watch_([&flag, patience_s](const std::stop_token& ended) {
        constexpr std::chrono::duration<double> between_looks(0.02);
        while (!flag.requested())
          if (work_ends_within(between_looks, ended)) return;
        if (work_ends_within(std::chrono::duration<double>(patience_s), ended)) return;
        const Interrupted stopped;
        spdlog::error("{}", stopped.what());
        _exit(stopped.exit_code());
      }) {}

}  // namespace voxweld
