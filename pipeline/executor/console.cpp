#include "pipeline/executor/console.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>

namespace voxweld {
namespace {

constexpr std::string_view erase_line = "\r\x1b[K";

// Unbuffered; what cannot be shown is dropped, since a closed terminal is no reason to fail.
void write_standard_error(std::string_view text) {
  while (!text.empty()) {
    const ssize_t written = ::write(STDERR_FILENO, text.data(), text.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return;
    text.remove_prefix(static_cast<std::size_t>(written));
  }
}

int standard_error_columns() {
  struct winsize size {};
  const bool known = ::ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0;
  return known ? size.ws_col : 80;
}

bool standard_error_is_terminal() {
  const char* term = std::getenv("TERM");
  return ::isatty(STDERR_FILENO) != 0 && term != nullptr && std::string_view(term) != "dumb";
}

}  // namespace

std::shared_ptr<Console> Console::standard_error() {
  return std::make_shared<Console>(
      ConsoleSettings{write_standard_error, standard_error_is_terminal(), standard_error_columns});
}

void Console::line(std::string_view text) {
  const std::scoped_lock lock(mutex_);
  // One write a line: other processes may share the stream.
  std::string out;
  if (!status_.empty()) out += erase_line;
  out += text;
  out += '\n';
  out += visible_status();
  settings_.write(out);
}

void Console::status(std::string text) {
  if (!settings_.terminal) return;
  const std::scoped_lock lock(mutex_);
  if (text.empty() && status_.empty()) return;
  status_ = std::move(text);
  settings_.write(std::string(erase_line) + visible_status());
}

std::string Console::visible_status() const {
  // One column is left free: some terminals wrap when the last one is written.
  const int columns = settings_.columns ? settings_.columns() : 80;
  return status_.substr(0, static_cast<std::size_t>(std::max(columns - 1, 1)));
}

}  // namespace voxweld
