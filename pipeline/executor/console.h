// The one place that writes to the user's terminal: whole lines, and on a terminal a status line
// below them that is redrawn in place, so that log messages and progress never mix.
#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>

namespace voxweld {

struct ConsoleSettings {
  std::function<void(std::string_view)> write;  // called with the lock held
  bool terminal = false;                        // a status line can be redrawn
  std::function<int()> columns;                 // width of the terminal; empty: 80
};

// Thread-safe.
class Console {
 public:
  explicit Console(ConsoleSettings settings) : settings_(std::move(settings)) {}
  // On standard error; a terminal only where it is one and TERM is not "dumb".
  static std::shared_ptr<Console> standard_error();

  bool terminal() const { return settings_.terminal; }
  // Writes `text` and a line end, above the status line where one is shown.
  void line(std::string_view text);
  // Shows `text` (no line end in it, cut to the width) as the status line. Nothing happens where
  // this is not a terminal.
  void status(std::string text);
  void clear_status() { status({}); }

 private:
  std::string visible_status() const;

  ConsoleSettings settings_;
  std::mutex mutex_;
  std::string status_;
};

}  // namespace voxweld
