// Runs the built program as a user does, and ends it as a crash or a user would.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace voxweld::testing {

using Arguments = std::vector<std::string>;
Arguments operator+(Arguments a, const Arguments& b);
// "--set" before each of "table.key=value".
Arguments set_options(const std::vector<std::string>& settings);

struct ProgramResult {
  int exit_code = -1;  // 128 + the signal that ended it
  std::string out, err;
  double seconds = 0;
};

// A signal sent this long after the start, unless the program has ended by then.
struct Stop {
  int signal = 0;
  double after_s = 0;
};

// While it lives, programs that are started have these variables beside the test's own.
class Environment {
 public:
  explicit Environment(std::vector<std::pair<std::string, std::string>> variables);
  ~Environment();
  Environment(const Environment&) = delete;
  Environment& operator=(const Environment&) = delete;

 private:
  std::vector<std::pair<std::string, std::optional<std::string>>> earlier_;
};

// `arguments` without the program's own name. Ended by force after two minutes.
ProgramResult run_voxweld(const Arguments& arguments, std::optional<Stop> stop = {});

}  // namespace voxweld::testing
