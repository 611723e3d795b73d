#include "pipeline/executor/log.h"

#include <spdlog/sinks/sink.h>
#include <spdlog/spdlog.h>

#include <string>

namespace voxweld {
namespace {

std::string_view prefix_of(spdlog::level::level_enum level) {
  switch (level) {
    case spdlog::level::trace:
    case spdlog::level::debug:
      return "debug: ";
    case spdlog::level::warn:
      return "warning: ";
    case spdlog::level::err:
    case spdlog::level::critical:
      return "error: ";
    default:
      return "";
  }
}

class ConsoleSink : public spdlog::sinks::sink {
 public:
  explicit ConsoleSink(std::shared_ptr<Console> console) : console_(std::move(console)) {}

  void log(const spdlog::details::log_msg& message) override {
    console_->line(std::string(prefix_of(message.level))
                       .append(message.payload.data(), message.payload.size()));
  }
  void flush() override {}
  // The form of a line is fixed.
  void set_pattern(const std::string&) override {}
  void set_formatter(std::unique_ptr<spdlog::formatter>) override {}

 private:
  std::shared_ptr<Console> console_;
};

spdlog::level::level_enum threshold(LogLevel level) {
  switch (level) {
    case LogLevel::quiet:
      return spdlog::level::err;
    case LogLevel::warning:
      return spdlog::level::warn;
    case LogLevel::info:
      return spdlog::level::info;
    case LogLevel::debug:
      break;
  }
  return spdlog::level::debug;
}

}  // namespace

std::optional<LogLevel> parse_log_level(std::string_view name) {
  if (name == "quiet") return LogLevel::quiet;
  if (name == "warning") return LogLevel::warning;
  if (name == "info") return LogLevel::info;
  if (name == "debug") return LogLevel::debug;
  return std::nullopt;
}

void set_up_logging(LogLevel level, std::shared_ptr<Console> console) {
  auto logger = std::make_shared<spdlog::logger>("voxweld",
                                                 std::make_shared<ConsoleSink>(std::move(console)));
  logger->set_level(threshold(level));
  spdlog::set_default_logger(std::move(logger));
}

}  // namespace voxweld
