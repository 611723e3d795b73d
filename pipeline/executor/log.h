// Log messages through spdlog, on the same console as the progress.
#pragma once

#include <memory>
#include <optional>
#include <string_view>

#include "pipeline/executor/console.h"

namespace voxweld {

enum class LogLevel {
  quiet,    // errors only
  warning,  // and warnings
  info,     // and progress and summaries
  debug,    // and what was decided and why
};

// "quiet", "warning", "info", "debug"; empty when unknown.
std::optional<LogLevel> parse_log_level(std::string_view name);
constexpr bool shows_progress(LogLevel level) {
  return level >= LogLevel::info;
}

// Makes spdlog::info() and the rest write to `console`: "warning: ...", "error: ...",
// "debug: ..."; information goes without a prefix. May be called again.
void set_up_logging(LogLevel level, std::shared_ptr<Console> console);

}  // namespace voxweld
