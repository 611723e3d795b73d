// A job script as text, written so that a person who wonders what ran can read it. Pure functions.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pipeline/config/config.h"

namespace voxweld {

struct BatchScript {
  struct Array {
    std::int64_t count = 1;        // tasks 0 .. count - 1; at least 1
    std::int64_t max_running = 0;  // at once; 0: no limit of ours
  };

  std::string name;           // of the job; not empty
  std::filesystem::path log;  // Slurm's pattern of the log file, absolute: see log_pattern()
  std::optional<Array> array;
  std::string dependency;    // "afterok:12:13"; empty: none
  SlurmConfig slurm;         // what a task asks for; its prologue and max_running are not looked at
  std::uint64_t memory = 0;  // bytes a task; above 0
  bool requeue = true;       // Slurm starts it again where its node fails
  std::vector<std::string> prologue;  // shell lines of the user's, before errors end the script
  std::vector<std::string> body;      // shell lines
};

// One that asks for what the config says; name, log and body are still to be filled in.
BatchScript batch_script(const Config& config);

// The text of the script. Precondition: the members are as said above, of one line each.
std::string render(const BatchScript& script);

// Lines for the body of an array: task N takes line N + 1 of `task_list`, whose words (between
// spaces; quotes mean nothing) become further arguments of `command`, which replaces the shell.
// Preconditions: `task_list` is absolute, `command` is not empty.
std::vector<std::string> array_body(const std::filesystem::path& task_list,
                                    std::span<const std::string> command);

// The word as a POSIX shell reads it back: unchanged where it is plain, else in single quotes.
std::string shell_quote(std::string_view word);

// "<folder>/%A_%a.log", or "<folder>/%j.log" of a job that is no array: one file a task. What Slurm
// would replace in the folder's own name is kept.
std::filesystem::path log_pattern(const std::filesystem::path& folder, bool array);

// Bytes to ask for a task: slurm.mem, or run.memory and 6 % of it, 64 MiB at least, for what the
// system counts to the task besides the process.
std::uint64_t task_memory(const Config& config);

}  // namespace voxweld
