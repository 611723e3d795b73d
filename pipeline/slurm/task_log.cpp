#include "pipeline/slurm/task_log.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <vector>

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

bool holds(std::string_view text, std::string_view lower_case) {
  const auto equal = [](char a, char b) { return (a >= 'A' && a <= 'Z' ? a + 32 : a) == b; };
  return std::search(text.begin(), text.end(), lower_case.begin(), lower_case.end(), equal) !=
         text.end();
}

// Slurm does without the folder it was submitted from: never why a task ended.
bool is_of_no_account(std::string_view line) {
  return holds(line, "couldn't chdir to");
}

// The shell's words when it cannot start a program have no "error" in them.
bool is_error(std::string_view line) {
  constexpr std::array known = {"error", "no such file or directory", "command not found",
                                "cannot execute", "permission denied"};
  return !is_of_no_account(line) &&
         std::any_of(known.begin(), known.end(), [&](const char* one) { return holds(line, one); });
}

// The script's own first line is "... task N on HOST: ARGUMENTS".
bool says_something(std::string_view line) {
  return line.find_first_not_of(" \t\r") != std::string_view::npos && !is_of_no_account(line) &&
         !(line.find(" task ") != std::string_view::npos &&
           line.find(": --") != std::string_view::npos);
}

}  // namespace

std::string last_words(const std::filesystem::path& log) {
  std::string_view text;
  const std::string tail = tail_of(log);
  std::string found;
  for (text = tail; !text.empty();) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = text.substr(0, end);
    // What came after an error is seldom the reason.
    if (says_something(line) && (is_error(line) || !is_error(found))) found = line;
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  if (found.empty()) {
    std::error_code error;
    const auto space = std::filesystem::space(log, error);
    if (!error && space.available < full_below)
      return fmt::format("the disk of {} is full", log.parent_path().string());
  }
  for (char& c : found)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = ' ';
  if (found.size() > longest) found = found.substr(0, longest) + "...";
  return found;
}

bool is_of_memory(std::string_view words) {
  // Slurm's own words, the kernel's, a program's.
  constexpr std::array known = {"memory limit", "oom-kill", "oom_kill", "oom kill",
                                "out of memory"};
  return std::any_of(known.begin(), known.end(),
                     [&](const char* one) { return holds(words, one); });
}

}  // namespace voxweld
