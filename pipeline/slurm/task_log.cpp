#include "pipeline/slurm/task_log.h"

#include <fmt/format.h>

#include <algorithm>

#include "pipeline/slurm/slurm_text.h"
#include "storage/support/error.h"
#include "storage/support/file_io.h"

namespace voxweld {
namespace {

constexpr std::uint64_t read_bytes = 4096;  // from the end
constexpr std::size_t longest = 300;
constexpr std::uintmax_t full_below = 65536;  // bytes a full disk may have left

std::string tail_of(const std::filesystem::path& log) {
  try {
    const ReadFile file(log);
    std::string text(std::min(file.size(), read_bytes), '\0');
    file.read(file.size() - text.size(), std::as_writable_bytes(std::span(text)));
    return text;
  } catch (const Error&) {  // there is none, or it is a folder
    return {};
  }
}

// Slurm does without the folder it was submitted from: never why a task ended.
bool is_of_no_account(std::string_view line) {
  return slurm_text::holds(line, {"couldn't chdir to"});
}

// The shell's words when it cannot start a program have no "error" in them.
bool is_error(std::string_view line) {
  return !is_of_no_account(line) &&
         slurm_text::holds(line, {"error", "no such file or directory", "command not found",
                                  "cannot execute", "permission denied"});
}

// The script's own first line is "... task N on HOST: ARGUMENTS".
bool says_something(std::string_view line) {
  return line.find_first_not_of(" \t\r") != std::string_view::npos && !is_of_no_account(line) &&
         !(line.find(" task ") != std::string_view::npos &&
           line.find(": --") != std::string_view::npos);
}

}  // namespace

std::string last_words(const std::filesystem::path& log) {
  const std::string tail = tail_of(log);
  std::string found;
  // What came after an error is seldom the reason.
  for (const std::string_view line : slurm_text::lines_of(tail))
    if (says_something(line) && (is_error(line) || !is_error(found))) found = line;
  if (found.empty()) {
    std::error_code error;
    const auto space = std::filesystem::space(log, error);
    if (!error && space.available < full_below)
      return fmt::format("the disk of {} is full", log.parent_path().string());
  }
  return slurm_text::one_line(found, longest);
}

bool is_of_memory(std::string_view words) {
  // Slurm's own words, the kernel's, a program's.
  return slurm_text::holds(words,
                           {"memory limit", "oom-kill", "oom_kill", "oom kill", "out of memory"});
}

}  // namespace voxweld
