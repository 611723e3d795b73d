#include "pipeline/slurm/idle_watch.h"

#include <fmt/format.h>

#include <utility>

#include "pipeline/slurm/slurm_text.h"

namespace voxweld {
namespace {

constexpr double quiet_s = 10, pause_s = 60;

}  // namespace

void IdleWatch::see(const TaskState& task) {
  if (task.state == TaskState::running) ++running_;
  if (task.state != TaskState::pending) return;
  ++waiting_;
  if (!why_.empty()) return;
  const std::string advice = slurm_text::outage_advice(task);
  if (!advice.empty()) why_ = fmt::format("{}: {}", task.reason, advice);
}

std::string IdleWatch::end_look(double now) {
  const std::uint64_t waiting = std::exchange(waiting_, 0);
  const bool idle = std::exchange(running_, 0) == 0;
  const std::string why = std::exchange(why_, {});
  if (!idle || why.empty()) {
    since_.reset();
    return {};
  }
  if (!since_) since_ = now;
  if (now - *since_ < quiet_s || (said_ && now - *said_ < pause_s)) return {};
  said_ = now;
  return fmt::format("{} {} and none runs; Slurm says {}", waiting,
                     waiting == 1 ? "task waits" : "tasks wait", why);
}

}  // namespace voxweld
