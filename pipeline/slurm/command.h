// Runs another program and reads what it says.
#pragma once

#include <chrono>
#include <span>
#include <string>
#include <vector>

namespace voxweld {

struct CommandOptions {
  std::chrono::milliseconds time_limit{60000};  // then the program and its children are killed
  std::string input = {};                       // its standard input; empty: nothing to read
  // Beginnings of the names of environment variables it shall not see: "SQUEUE_".
  std::vector<std::string> hidden_variables = {};
};

struct CommandResult {
  int exit_code = 0;  // 128 + N where signal N ended it, as a shell has it
  std::string out, err;
  bool timed_out = false;  // killed; `out` and `err` hold what came before
};

// Runs words[0], searched on PATH, with the other words as its arguments; no shell is between.
// It has a process group of its own: a Ctrl-C meant for this process does not reach it.
// Precondition: `words` is not empty. Throws StorageError, naming the program, when it cannot be
// started; error_number() is ENOENT when there is none of that name.
CommandResult run_command(std::span<const std::string> words, const CommandOptions& options = {});

}  // namespace voxweld
