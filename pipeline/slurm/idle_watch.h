// Notices that none of a stage's tasks runs because nodes are out of use, and when to say so.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "pipeline/slurm/slurm_client.h"

namespace voxweld {

class IdleWatch {
 public:
  // Told of every task in the queue, at each look at it.
  void see(const TaskState& task);
  // At the end of the look, what to tell the user; mostly nothing. An outage of a few seconds is
  // kept quiet, a longer one is told once a minute.
  std::string end_look(double now);

 private:
  std::uint64_t waiting_ = 0, running_ = 0;  // in this look
  std::string why_;
  std::optional<double> since_, said_;
};

}  // namespace voxweld
