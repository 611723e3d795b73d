#include "pipeline/run/output_claim.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "pipeline/encode/output_files.h"
#include "storage/support/error.h"

namespace voxweld {
namespace {

std::string owner_name(const RunContext& context) {
  return context.config_file.string();
}

void refuse_other(const RunContext& context, const LockHolder& holder) {
  if (holder.owner == owner_name(context)) return;
  throw InputError(fmt::format(
      "output.directory = \"{}\": process {} on {} is writing it for {}; choose another directory, "
      "or wait until that run has ended",
      context.config.output.directory.string(), holder.process, holder.host, holder.owner));
}

LockOptions options_of(const RunContext& context) {
  LockOptions options;
  options.waiting = [&context, told = false](const LockHolder& holder) mutable {
    refuse_other(context, holder);
    if (context.interrupt != nullptr) context.interrupt->check();
    if (!std::exchange(told, true))
      spdlog::info("waiting for process {} on {}, which runs the same config", holder.process,
                   holder.host);
  };
  return options;
}

const std::filesystem::path& checked_directory(const RunContext& context) {
  const std::filesystem::path& directory = context.config.output.directory;
  if (!context.force) check_owner(directory, context.config_file);
  return directory;
}

}  // namespace

void check_claim(const RunContext& context) {
  if (const auto holder = lock_holder(checked_directory(context))) refuse_other(context, *holder);
}

OutputClaim::OutputClaim(RunContext& context)
    : context_(context),
      lock_(checked_directory(context), owner_name(context), options_of(context)) {
  checked_directory(context);  // it may have become another's before it was locked
  context.lock = &lock_;
}

}  // namespace voxweld
