#include "pipeline/slurm/batch_script.h"

#include <fmt/format.h>

#include <algorithm>

namespace voxweld {
namespace {

constexpr std::uint64_t mebibyte = std::uint64_t{1} << 20;

bool is_plain(std::string_view word) {
  return !word.empty() && std::all_of(word.begin(), word.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
           std::string_view("_-./:=,@%+").find(c) != std::string_view::npos;
  });
}

// As sbatch reads its #SBATCH lines, which is not as a shell does: a backslash counts inside single
// quotes too, and $ means nothing.
std::string sbatch_quote(std::string_view word) {
  if (is_plain(word)) return std::string(word);
  std::string text = "\"";
  for (const char c : word) {
    if (c == '"' || c == '\\') text += '\\';
    text += c;
  }
  return text + "\"";
}

class Options {
 public:
  void flag(const std::string& option) { text_ += "#SBATCH " + option + "\n"; }
  void value(const std::string& name, const std::string& value) {
    flag(fmt::format("--{}={}", name, sbatch_quote(value)));
  }
  // Left out where it is empty: the cluster's default.
  void value_if_any(const std::string& name, const std::string& text) {
    if (!text.empty()) value(name, text);
  }
  const std::string& text() const { return text_; }

 private:
  std::string text_;
};

std::string array_text(const BatchScript::Array& array) {
  const std::string limit = array.max_running > 0 ? fmt::format("%{}", array.max_running) : "";
  return fmt::format("0-{}{}", array.count - 1, limit);
}

std::string options_text(const BatchScript& script) {
  Options options;
  options.value("job-name", script.name);
  options.value("output", script.log.string());
  options.flag("--open-mode=append");
  if (script.array) options.value("array", array_text(*script.array));
  options.value_if_any("dependency", script.dependency);
  // A job that waits for one that failed would wait for ever.
  options.flag("--kill-on-invalid-dep=yes");
  options.value_if_any("partition", script.slurm.partition);
  options.value_if_any("account", script.slurm.account);
  options.value_if_any("qos", script.slurm.qos);
  options.value("time", script.slurm.time);
  options.flag("--nodes=1");
  options.flag("--ntasks=1");
  options.value("cpus-per-task", std::to_string(script.slurm.cpus_per_task));
  options.value("mem", fmt::format("{}M", (script.memory + mebibyte - 1) / mebibyte));
  options.flag(script.requeue ? "--requeue" : "--no-requeue");
  for (const std::string& extra : script.slurm.extra) options.flag(extra);
  return options.text();
}

std::string without_trailing_space(const std::string& line) {
  return line.substr(0, line.find_last_not_of(" \t") + 1);
}

}  // namespace

BatchScript batch_script(const Config& config) {
  BatchScript script;
  script.slurm = config.slurm;
  script.memory = task_memory(config);
  script.prologue = config.slurm.prologue;
  return script;
}

std::string render(const BatchScript& script) {
  std::string text = "#!/bin/bash\n" + options_text(script) + "\n";
  // Before `set -eu`: modules and environments are seldom written for it.
  for (const std::string& line : script.prologue) text += without_trailing_space(line) + "\n";
  if (!script.prologue.empty()) text += "\n";
  text += "set -eu\n";
  for (const std::string& line : script.body) text += without_trailing_space(line) + "\n";
  return text;
}

std::vector<std::string> array_body(const std::filesystem::path& task_list,
                                    std::span<const std::string> command) {
  std::string words;
  for (const std::string& word : command) {
    if (!words.empty()) words += ' ';
    words += shell_quote(word);
  }
  return {
      "# Task N of the array takes line N + 1 of the list.",
      fmt::format("tasks={}", shell_quote(task_list.string())),
      "line=$(sed -n \"$((SLURM_ARRAY_TASK_ID + 1))p\" \"$tasks\")",
      "if [ -z \"$line\" ]; then",
      "  echo \"$tasks has no line $((SLURM_ARRAY_TASK_ID + 1))\" >&2",
      "  exit 2",
      "fi",
      "echo \"$(date '+%F %T') task $SLURM_ARRAY_TASK_ID on $(hostname): $line\"",
      "read -r -a arguments <<<\"$line\"",
      fmt::format("exec {} \"${{arguments[@]}}\"", words),
  };
}

std::string shell_quote(std::string_view word) {
  if (is_plain(word)) return std::string(word);
  std::string text = "'";
  for (const char c : word) {
    if (c == '\'')
      text += "'\\''";
    else
      text += c;
  }
  return text + "'";
}

std::filesystem::path log_pattern(const std::filesystem::path& folder, bool array) {
  std::string text;
  for (const char c : folder.string()) text += c == '%' ? "%%" : std::string(1, c);
  return std::filesystem::path(text) / (array ? "%A_%a.log" : "%j.log");
}

std::uint64_t task_memory(const Config& config) {
  if (config.slurm.mem != 0) return config.slurm.mem;
  const std::uint64_t memory = config.run.memory;
  return memory + std::max(memory / 100 * 6, 64 * mebibyte);
}

}  // namespace voxweld
