// What Slurm's programs print, read: job ids, the states of tasks, and which error is whose.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pipeline/slurm/slurm_client.h"

namespace voxweld::slurm_text {

// Those that are not empty.
std::vector<std::string_view> lines_of(std::string_view text);
// Whether one of the parts stands in the text, in whatever letter case.
bool holds(std::string_view text, std::initializer_list<const char*> parts);
// Without control characters, cut where it is longer than that.
std::string one_line(std::string text, std::size_t longest);

// The job id that `sbatch --parsable` printed: "123" or "123;cluster", after whatever a plugin of
// the site says. Empty when there is none.
std::optional<std::int64_t> submitted_job(const std::string& out);

// For `squeue -o`: what parse_tasks reads.
inline constexpr const char* task_format = "%F|%K|%T|%N|%j|%r";
// One task a line. Throws StorageError, quoting the line, when one is not in that format.
std::vector<TaskState> parse_tasks(const std::string& out);

// Why Slurm will not start a pending task, however long one waits: held, its launch failed, no
// place for it anywhere. Empty where it may come to start.
std::string stuck_reason(const TaskState& task);
// Whether such a reason tells of a failed launch: another node may do better.
bool is_failed_launch(std::string_view reason);

// What to do about a pending task's reason that concerns nodes out of use, which may come back;
// empty for a task that waits its turn.
std::string outage_advice(const TaskState& task);

// Whether the words say that the controller could not be asked, so that asking again may help.
bool is_unanswered(std::string_view words);
// Whether they say only that a job is over or forgotten.
bool is_unknown_job(std::string_view words);
// The config's keys that the words are likely about: "slurm.partition". Empty for other errors.
std::string likely_setting(std::string_view words);

// What a program said in one line: without its name on every line, cut where it is long.
std::string said(const std::string& err);

}  // namespace voxweld::slurm_text
