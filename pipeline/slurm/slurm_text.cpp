#include "pipeline/slurm/slurm_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>

#include "storage/support/error.h"
#include "storage/support/text_fields.h"

namespace voxweld::slurm_text {
namespace {

std::optional<std::int64_t> whole_number(std::string_view text) {
  const auto number = parse_integer(text);
  return number && *number >= 0 ? number : std::nullopt;
}

// Slurm has a dozen words for the same three: waiting, on a node, over.
TaskState::State state_of(std::string_view word) {
  constexpr std::array pending = {"PENDING",      "REQUEUED",     "REQUEUE_FED",
                                  "REQUEUE_HOLD", "SPECIAL_EXIT", "RESV_DEL_HOLD"};
  constexpr std::array running = {"RUNNING",   "CONFIGURING", "SUSPENDED",    "STOPPED",
                                  "SIGNALING", "RESIZING",    "POWER_UP_NODE"};
  constexpr std::array completing = {"COMPLETING", "STAGE_OUT"};
  const auto one_of = [&](const auto& words) {
    return std::find(words.begin(), words.end(), word) != words.end();
  };
  if (one_of(pending)) return TaskState::pending;
  if (one_of(running)) return TaskState::running;
  if (one_of(completing)) return TaskState::completing;
  return TaskState::gone;
}

TaskState parse_task(std::string_view line) {
  std::array<std::string_view, 6> fields;
  std::string_view rest = line;
  // The last field, the reason, may hold anything.
  for (std::size_t i = 0; i + 1 < fields.size(); ++i) {
    const std::size_t bar = std::min(rest.find('|'), rest.size());
    fields[i] = rest.substr(0, bar);
    rest.remove_prefix(std::min(bar + 1, rest.size()));
  }
  fields[5] = rest;
  const auto job = whole_number(fields[0]);
  if (!job || fields[2].empty())
    throw StorageError(fmt::format("squeue: expected job|task|state|node|name|reason, found \"{}\"",
                                   said(std::string(line))));
  TaskState task;
  task.job = *job;
  task.task = whole_number(fields[1]).value_or(-1);  // "N/A" of a job that is no array
  task.state = state_of(fields[2]);
  task.slurm_state = fields[2];
  task.node = fields[3];
  task.name = fields[4];
  task.reason = fields[5];
  return task;
}

struct Complaint {
  const char* words;
  const char* keys;
};

// Slurm's error texts are the only thing that tells its errors apart: the exit code is 1 for all.
constexpr std::array<Complaint, 24> complaints = {{
    {"invalid partition", "slurm.partition"},
    {"required partition not available", "slurm.partition"},
    {"not permitted to use this partition", "slurm.partition or slurm.account"},
    {"invalid account", "slurm.account or slurm.partition"},
    {"invalid qos", "slurm.qos"},
    {"invalid --time", "slurm.time"},
    {"requested time limit is invalid", "slurm.time, or the limit of slurm.partition"},
    {"memory specification can not be satisfied",
     "slurm.mem, or run.memory where that is \"auto\""},
    {"invalid --mem", "slurm.mem, or run.memory where that is \"auto\""},
    {"cpu count per node can not be satisfied", "slurm.cpus_per_task"},
    {"more processors requested than permitted", "slurm.cpus_per_task"},
    {"requested node configuration is not available",
     "slurm.cpus_per_task, slurm.mem or slurm.extra, which ask for more than any node of "
     "slurm.partition has"},
    {"invalid job array", "slurm.max_array, which may be above the cluster's MaxArraySize"},
    {"job array index", "slurm.max_array, which may be above the cluster's MaxArraySize"},
    {"violates accounting/qos policy",
     "slurm.qos, slurm.time, or slurm.max_array where the number of submitted jobs is limited"},
    {"access/permission denied", "slurm.partition or slurm.account"},
    {"invalid feature", "slurm.extra"},
    {"invalid generic resource", "slurm.extra"},
    {"invalid gres", "slurm.extra"},
    {"invalid license", "slurm.extra"},
    {"requested reservation", "slurm.extra"},
    {"node count specification", "slurm.extra"},
    {"unrecognized option", "slurm.extra"},
    {"invalid option", "slurm.extra"},
}};

}  // namespace

std::vector<std::string_view> lines_of(std::string_view text) {
  std::vector<std::string_view> lines;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    if (end > 0) lines.push_back(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return lines;
}

bool holds(std::string_view text, std::initializer_list<const char*> parts) {
  const std::string lower_text = lower(text);
  return std::ranges::any_of(
      parts, [&](const char* part) { return lower_text.find(lower(part)) != std::string::npos; });
}

std::string one_line(std::string text, std::size_t longest) {
  for (char& c : text)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = ' ';
  return text.size() > longest ? text.substr(0, longest) + "..." : text;
}

std::optional<std::int64_t> submitted_job(const std::string& out) {
  const auto lines = lines_of(out);
  if (lines.empty()) return std::nullopt;
  const std::string_view last = lines.back();
  return whole_number(last.substr(0, last.find(';')));
}

std::vector<TaskState> parse_tasks(const std::string& out) {
  std::vector<TaskState> tasks;
  for (const std::string_view line : lines_of(out)) tasks.push_back(parse_task(line));
  return tasks;
}

std::string stuck_reason(const TaskState& task) {
  if (task.state != TaskState::pending) return {};
  if (task.slurm_state == "REQUEUE_HOLD" || task.slurm_state == "SPECIAL_EXIT")
    return task.reason.empty() ? task.slurm_state : task.reason;
  // Limits of a single job's size are "...PerJob" or "...PerJobLimit"; those of what an account has
  // running pass. Partitions and nodes that are down come back.
  const bool stuck = holds(task.reason, {"JobHeld", "held", "JobHoldMaxRequeue", "NeverSatisfied",
                                         "PerJob", "BadConstraints", "InvalidAccount", "InvalidQOS",
                                         "PartitionTimeLimit", "PartitionNodeLimit"});
  return stuck ? task.reason : std::string();
}

bool is_failed_launch(std::string_view reason) {
  return holds(reason, {"launch", "JobHoldMaxRequeue"});
}

std::string outage_advice(const TaskState& task) {
  if (task.state != TaskState::pending) return {};
  // "Nodes required for job are DOWN, DRAINED or reserved for jobs in higher priority partitions",
  // "ReqNodeNotAvail, UnavailableNodes:n1"
  if (holds(task.reason, {"DOWN, DRAINED", "ReqNodeNotAvail", "NodeDown"}))
    return "`sinfo -R` says which nodes are out of use and why; change slurm.partition, or wait";
  if (holds(task.reason, {"PartitionDown", "PartitionInactive"}))
    return "its partition takes no jobs now; change slurm.partition, or wait";
  if (holds(task.reason, {"Reservation"}))
    return "it waits for a reservation (`scontrol show reservation`) that slurm.extra names";
  return {};
}

bool is_unanswered(std::string_view words) {
  return holds(
      words,
      {"unable to contact slurm controller", "connect failure", "communication connection failure",
       "socket timed out", "connection refused", "connection timed out", "connection reset",
       "no route to host", "network is unreachable", "transport endpoint is not connected",
       "zero bytes were transmitted", "message receive failure", "message send failure",
       "unexpected message", "insane message length", "in standby mode", "temporarily unable",
       "resource temporarily unavailable", "missing socket error", "slurm_msg_sendto",
       "broken pipe",
       // Munge, which restarts when its key or the clock changes.
       "munge encode failed", "munge decode failed", "protocol authentication error"});
}

bool is_unknown_job(std::string_view words) {
  const auto lines = lines_of(words);
  return !lines.empty() && std::all_of(lines.begin(), lines.end(), [](std::string_view line) {
    return holds(line, {"invalid job id", "already completing or completed"});
  });
}

std::string likely_setting(std::string_view words) {
  for (const Complaint& complaint : complaints)
    if (holds(words, {complaint.words})) return complaint.keys;
  return {};
}

std::string said(const std::string& err) {
  constexpr std::size_t longest = 600;
  std::string text;
  for (std::string_view line : lines_of(err)) {
    for (const char* prefix : {"sbatch: ", "squeue: ", "scancel: ", "error: ", "fatal: "})
      if (line.starts_with(prefix)) line.remove_prefix(std::strlen(prefix));
    if (!text.empty()) text += "; ";
    text += line;
  }
  return text.empty() ? "no message" : one_line(text, longest);
}

}  // namespace voxweld::slurm_text
