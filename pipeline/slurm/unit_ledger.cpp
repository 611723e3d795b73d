#include "pipeline/slurm/unit_ledger.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "pipeline/executor/probe.h"
#include "pipeline/slurm/slurm_text.h"
#include "pipeline/slurm/task_log.h"

namespace voxweld {
namespace {

std::string hint_for(const FlightEnd& end) {
  const std::string& state = end.slurm_state;
  if (state == "TIMEOUT" || state == "DEADLINE") return " (slurm.time is too short for it)";
  if (state == "OUT_OF_MEMORY" || is_of_memory(end.last_words))
    return " (raise slurm.mem, or lower run.memory)";
  return "";
}

// True when the task came to its end by itself. Otherwise it was sent a signal, and what it may
// have said last, that it was asked to stop, is not the reason.
bool ended_by_itself(const std::string& state) {
  return state.empty() || state == "FAILED" || state == "COMPLETED";
}

// What the report says of the unit, or of the task where it names no unit; null when nothing.
const TaskFailure* failure_of(const FlightEnd& end, std::uint64_t unit) {
  if (!end.report) return nullptr;
  const TaskFailure* whole = nullptr;
  for (const TaskFailure& failure : end.report->failures) {
    if (failure.unit == unit) return &failure;
    if (!failure.unit) whole = &failure;
  }
  return ended_by_itself(end.slurm_state) ? whole : nullptr;
}

std::string without_digits(std::string text) {
  std::erase_if(text, [](char c) { return c >= '0' && c <= '9'; });
  return text;
}

// By whoever may: a task that was told to stop may have said so in a report.
bool was_cancelled(const FlightEnd& end) {
  return end.slurm_state == "CANCELLED" && !(end.report && end.report->exit_code == 0);
}

std::string why(const FlightEnd& end, const TaskFailure* failure) {
  if (!end.stuck.empty())
    return fmt::format("Slurm would not start its task ({}), which is cancelled now", end.stuck);
  if (failure != nullptr && failure->unit) return failure->message;
  if (was_cancelled(end)) return "its task was cancelled";
  if (failure != nullptr) return failure->message;
  if (end.report && end.report->exit_code == 0)
    return "its task says it is done, but the result cannot be seen from here: is work.directory "
           "the same shared folder on every node?";
  if (end.slurm_state.empty()) return "its task was lost: Slurm knows nothing of it any more";
  const std::string words =
      end.last_words.empty() ? "" : fmt::format("; last it said: {}", end.last_words);
  return fmt::format("its task ended as {}{}{}", end.slurm_state, hint_for(end), words);
}

// Whether trying again would end the same: the user has to mend something, or wanted it to end.
bool is_final(const FlightEnd& end, const TaskFailure* failure) {
  if (!end.stuck.empty()) return !slurm_text::is_failed_launch(end.stuck);
  if (was_cancelled(end)) return true;
  return failure != nullptr && (failure->exit_code == 2 || !failure->damaged_path.empty());
}

}  // namespace

UnitLedger::UnitLedger(std::span<const Unit> units, std::function<bool(const Unit&)> done,
                       std::int64_t retries)
    : done_(std::move(done)), retries_(retries), open_(units.size()) {
  for (const Unit& unit : units) entries_[unit.key].unit = unit;
}

std::vector<Unit> UnitLedger::ready(double now) const {
  std::vector<Unit> units;
  for (const auto& [key, entry] : entries_)
    if (entry.state == State::waiting && entry.not_before <= now) units.push_back(entry.unit);
  return units;
}

bool UnitLedger::take_off(Flight flight) {
  std::vector<std::uint64_t> taken;
  for (const std::uint64_t key : flight.units) {
    const auto at = entries_.find(key);
    if (at == entries_.end() || at->second.state != State::waiting) continue;
    at->second.state = State::flying;
    taken.push_back(key);
  }
  if (taken.empty()) return false;
  flight.units = std::move(taken);
  flights_.push_back(std::move(flight));
  return true;
}

std::vector<double> UnitLedger::look(Flight& flight, std::size_t& most, bool in_order) {
  const std::size_t count = std::min(most, flight.units.size());
  const auto is_done = [&](std::size_t i) { return done_(entries_.at(flight.units[i]).unit); };
  std::vector<std::size_t> which;
  if (in_order) {
    while (which.size() < count && is_done(which.size())) which.push_back(which.size());
    most -= std::min(count, which.size() + 1);
  } else {
    which = probe_which(count, is_done);
    most -= count;
  }
  std::vector<double> found;
  for (const std::size_t i : which) {
    Entry& entry = entries_.at(flight.units[i]);
    entry.state = State::done;
    --open_;
    found.push_back(entry.unit.weight);
  }
  for (auto i = which.rbegin(); i != which.rend(); ++i)
    flight.units.erase(flight.units.begin() + static_cast<std::ptrdiff_t>(*i));
  return found;
}

void UnitLedger::fail(const Flight& flight, const FlightEnd& end, double now) {
  for (const std::uint64_t key : flight.units) {
    Entry& entry = entries_.at(key);
    const TaskFailure* failure = failure_of(end, key);
    ++entry.failures;
    if (!is_final(end, failure) && entry.failures <= retries_) {
      // A full disk or a node that fails everything at once shall not use up all tries in a second.
      const double pause = std::min(60.0, std::exp2(static_cast<double>(entry.failures)));
      entry.state = State::waiting;
      entry.not_before = now + pause;
      continue;
    }
    entry.state = State::given_up;
    --open_;
    const std::string tried =
        entry.failures > 1 ? fmt::format(" (tried {} times)", entry.failures) : "";
    entry.error.key = key;
    entry.error.unit = entry.unit.name;
    entry.error.message = why(end, failure) + tried;
    entry.log = flight.folder.log_path(flight.job, flight.task).string();
    if (!end.stuck.empty() && !slurm_text::is_failed_launch(end.stuck)) {
      entry.error.exit_code = 2;
    } else if (failure != nullptr) {
      entry.error.exit_code = failure->exit_code;
      entry.error.damaged_path = failure->damaged_path;
    }
  }
}

void UnitLedger::sweep() {
  std::erase_if(flights_, [](const Flight& flight) { return flight.units.empty(); });
}

std::vector<UnitError> UnitLedger::errors() const {
  std::vector<UnitError> errors;
  std::map<std::string, std::string> messages;
  for (const auto& [key, entry] : entries_) {
    if (entry.state != State::given_up) continue;
    errors.push_back(entry.error);
    std::string& message = errors.back().message;
    message =
        messages.emplace(without_digits(message), message + "; log: " + entry.log).first->second;
  }
  return errors;
}

}  // namespace voxweld
