#include "pipeline/stage/work_claim.h"

#include <spdlog/spdlog.h>

#include <utility>

namespace voxweld {
namespace {

LockOptions lock_options(const RunContext& context) {
  LockOptions options;
  options.waiting = [&context, told = false](const LockHolder& holder) mutable {
    if (context.interrupt != nullptr) context.interrupt->check();
    if (!std::exchange(told, true))
      spdlog::info("waiting for process {} on {}, which is at work on the same files for {}",
                   holder.process, holder.host, holder.owner);
  };
  return options;
}

}  // namespace

WorkClaim::WorkClaim(const RunContext& context, const std::filesystem::path& folder)
    : lock_(folder, context.config_file.string(), lock_options(context)) {}

}  // namespace voxweld
