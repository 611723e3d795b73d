#include "pipeline/slurm/slurm_executor.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <map>
#include <set>
#include <thread>

#include "pipeline/executor/progress.h"
#include "pipeline/slurm/idle_watch.h"
#include "pipeline/slurm/queued_tasks.h"
#include "pipeline/slurm/slurm_text.h"
#include "pipeline/slurm/task_cost.h"
#include "pipeline/slurm/task_log.h"
#include "pipeline/slurm/task_plan.h"
#include "pipeline/slurm/unit_ledger.h"
#include "storage/support/error.h"
#include "storage/support/file_io.h"

namespace voxweld {
namespace {

constexpr double report_pause_s = 0.2;     // between two looks for reports, at least
constexpr std::size_t looks_a_poll = 200;  // at results of tasks that are still running

double steady_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

// One stage under way: arrays are submitted until nothing is left that is worth trying.
class StageOnSlurm {
 public:
  StageOnSlurm(const SlurmSetup& setup, SlurmClient& client, StageName stage,
               std::span<const Unit> units, const RunOptions& options)
      : setup_(setup),
        client_(client),
        stage_(stage),
        units_(units),
        options_(options),
        parent_(setup.folder / (options.identity.empty() ? std::string(stage) : options.identity)),
        ledger_(units, options.done, setup.config.slurm.retries) {}

  void run() {
    adopt();
    while (ledger_.open()) {
      check_interrupt();
      submit(ledger_.ready(steady_seconds()));
      wait_for_reports(pause_s_);
      pause_s_ = std::min(pause_s_ * 1.5, setup_.poll_s);
      look();
    }
    take_from_queue();
    collect_reports();
    const std::vector<UnitError> errors = ledger_.errors();
    if (!errors.empty()) throw ErrorSet(std::string(stage_), errors);
  }

 private:
  // Tasks that an earlier process submitted and that Slurm has not forgotten.
  void adopt() {
    if (options_.identity.empty()) return;
    std::size_t taken = 0;
    std::vector<std::uint64_t> keys;
    for (const Unit& unit : units_) keys.push_back(unit.key);
    std::sort(keys.begin(), keys.end());
    earlier_ = ArrayFolder::all(parent_);
    std::vector<QueuedTasks> queued = queued_tasks(arrays_of_step(parent_), client_);
    std::reverse(queued.begin(), queued.end());
    for (const auto& [array, tasks] : queued) {
      const ArrayFolder& folder = array.folder;
      if (!folder.job()) folder.set_job(array.job);  // whoever submitted it died before
      std::set<std::int64_t> alive;
      for (const TaskState& task : tasks)
        if (task.state != TaskState::gone) alive.insert(task.task);
      if (alive.empty()) continue;
      const std::vector<std::string> lines = folder.tasks();
      keep(folder, lines.size());
      for (std::size_t i = 0; i < lines.size(); ++i) {
        const auto task = static_cast<std::int64_t>(i);
        if (alive.count(task) == 0) continue;
        const Flight flight{array.job, task, folder, task_selection(lines[i]).among(keys), {}};
        taken += ledger_.take_off(flight) ? 1 : 0;
      }
    }
    if (taken > 0) spdlog::info("{}: {} tasks are in Slurm already", stage_, taken);
  }

  void submit(const std::vector<Unit>& ready) {
    if (ready.empty()) return;
    const std::vector<PlannedTask> tasks = plan_stage_tasks(setup_, stage_, ready);
    const auto most = static_cast<std::size_t>(setup_.config.slurm.max_array);
    for (std::size_t at = 0; at < tasks.size(); at += most)
      submit_array(std::span(tasks).subspan(at, std::min(most, tasks.size() - at)));
  }

  void submit_array(std::span<const PlannedTask> tasks) {
    std::vector<std::string> lines;
    for (const PlannedTask& task : tasks) lines.push_back(task_arguments(stage_, task));
    const ArrayFolder folder =
        ArrayFolder::create(parent_, lines, unique_job_name(fmt::format("voxweld-{}", stage_)));
    const std::string text = stage_script(setup_, stage_, folder, tasks.size());
    write_whole_file(folder.script_path(), as_bytes(text), Durability::rename_only);
    const std::int64_t job = client_.submit(folder.script_path(), folder.name());
    try {
      folder.set_job(job);
    } catch (const StorageError&) {
      client_.cancel({&job, 1});  // its tasks could not write either
      throw;
    }
    keep(folder, tasks.size());
    spdlog::info("{}: job {} of {} tasks; its script and logs: {}", stage_, job, tasks.size(),
                 folder.path().string());
    for (std::size_t i = 0; i < tasks.size(); ++i)
      ledger_.take_off({job, static_cast<std::int64_t>(i), folder, tasks[i].units, {}});
  }

  void keep(const ArrayFolder& folder, std::size_t tasks) {
    arrays_.emplace_back(folder, tasks);
    names_[folder.path().string()] = folder.name();
  }

  // Waits for the next look at the queue, and meanwhile settles what tasks report to be done: that
  // asks the disk alone, so it can be asked often.
  void wait_for_reports(double seconds) {
    const double until = steady_seconds() + seconds;
    double pause = report_pause_s;
    while (ledger_.open() && steady_seconds() < until) {
      wait(std::min(pause, until - steady_seconds()));
      const double before = steady_seconds();
      settle_reported();
      // Never most of the time, however far the disk is.
      pause = std::max(report_pause_s, 10 * (steady_seconds() - before));
    }
  }

  void settle_reported() {
    std::set<std::string> changed;
    for (const auto& [folder, tasks] : arrays_)
      if (has_news(folder)) changed.insert(folder.path().string());
    if (changed.empty()) return;
    for (Flight& flight : ledger_.flights()) {
      if (changed.count(flight.folder.path().string()) == 0) continue;
      const auto report = read_task_report(flight.folder.report_path(flight.task));
      if (!report || report->exit_code != 0) continue;  // what failed may have been requeued
      std::size_t all = flight.units.size();
      note_done(ledger_.look(flight, all, false));
    }
    ledger_.sweep();
  }

  bool has_news(const ArrayFolder& folder) {
    std::error_code error;
    const auto time = std::filesystem::last_write_time(folder.reports(), error);
    if (error) return false;
    const auto [at, is_new] = reported_.try_emplace(folder.path().string(), time);
    const bool changed = is_new || at->second != time;
    at->second = time;
    return changed;
  }

  void look() {
    std::set<std::int64_t> jobs;
    for (const Flight& flight : ledger_.flights()) jobs.insert(flight.job);
    if (jobs.empty()) return;
    std::map<std::pair<std::int64_t, std::int64_t>, TaskState> states;
    for (TaskState& state : client_.tasks(std::vector(jobs.begin(), jobs.end())))
      states.emplace(std::pair(state.job, state.task), std::move(state));
    std::size_t looks = looks_a_poll;
    std::vector<std::pair<std::int64_t, std::int64_t>> needless;
    for (Flight& flight : ledger_.flights()) {
      const auto at = states.find({flight.job, flight.task});
      // A controller that lost its last seconds gives an id again: then that job is another's.
      const bool known =
          at != states.end() && at->second.name == names_.at(flight.folder.path().string());
      if (!known || at->second.state == TaskState::gone) {
        settle(flight, known ? at->second.slurm_state : std::string());
      } else {
        flight.over_since.reset();
        idle_watch_.see(at->second);
        note_done(ledger_.look(flight, looks, true));
        // One that was requeued may wait, or be held for ever, with all its results in place.
        const bool waits_for_nothing =
            flight.units.empty() && at->second.state == TaskState::pending;
        if (waits_for_nothing || is_stuck(flight, at->second))
          needless.emplace_back(flight.job, flight.task);
      }
    }
    const std::string idle = idle_watch_.end_look(steady_seconds());
    if (!idle.empty()) spdlog::warn("{}: {}", stage_, idle);
    ledger_.sweep();
    client_.cancel_tasks(needless);
  }

  // A task that Slurm will not start has failed: nobody shall wait for it for ever.
  bool is_stuck(Flight& flight, const TaskState& state) {
    std::string reason = standstill(state);  // with what to change
    if (reason.empty()) reason = slurm_text::stuck_reason(state);
    const double now = steady_seconds();
    if (reason.empty() || flight.units.empty()) {
      flight.stuck_since.reset();
      return false;
    }
    if (!flight.stuck_since) flight.stuck_since = now;
    if (now - *flight.stuck_since < setup_.stuck_after_s) return false;
    spdlog::warn("{}: task {}_{} is not started by Slurm ({}); it is cancelled", stage_, flight.job,
                 flight.task, reason);
    FlightEnd end;
    end.slurm_state = state.slurm_state;
    end.stuck = reason;
    ledger_.fail(flight, end, now);
    flight.units.clear();
    return true;
  }

  void settle(Flight& flight, const std::string& slurm_state) {
    std::size_t all = flight.units.size();
    note_done(ledger_.look(flight, all, false));
    FlightEnd end;
    end.report = read_task_report(flight.folder.report_path(flight.task));
    end.slurm_state = slurm_state;
    if (!flight.units.empty()) {
      const double now = steady_seconds();
      const bool first_look = !flight.over_since;
      if (first_look) flight.over_since = now;
      // What a task wrote may not be seen here at once.
      const bool may_come = end.report ? end.report->exit_code == 0
                                       : slurm_state.empty() || slurm_state == "COMPLETED";
      if (may_come && first_look) check_input();
      if (may_come && now - *flight.over_since < setup_.visible_after_s) return;
      if (!end.report) end.last_words = last_words(flight.folder.log_path(flight.job, flight.task));
      if (!end.report || end.report->exit_code != 2)
        spdlog::warn("{}: task {}_{} left {} of its units undone ({})", stage_, flight.job,
                     flight.task, flight.units.size(), slurm_state.empty() ? "lost" : slurm_state);
      ledger_.fail(flight, end, now);
      flight.units.clear();
    }
  }

  // What waits in the queue at the end would only find that nothing is left to do: a task that was
  // requeued after its results were seen, or whose units were done by another, an array that Slurm
  // took late.
  void take_from_queue() {
    std::vector<std::string> names;
    for (const auto& [folder, name] : names_) names.push_back(name);
    for (const ArrayFolder& folder : earlier_)
      if (const std::string name = folder.name(); !name.empty()) names.push_back(name);
    try {
      client_.cancel_pending(names);
    } catch (const Error& error) {
      spdlog::warn("{}: tasks that nobody waits for may be left in the queue: {}", stage_,
                   error.what());
    }
  }

  // A task that began after the input had changed has made what we do not wait for.
  void check_input() {
    if (!options_.check_input) return;
    try {
      options_.check_input();
    } catch (const Error&) {
      take_from_queue();
      throw;
    }
  }

  // For the figures; a task's report comes shortly after its last result.
  void collect_reports() {
    if (options_.elsewhere == nullptr) return;
    const double until = steady_seconds() + 3;
    for (const auto& [folder, tasks] : arrays_)
      for (std::size_t task = 0; task < tasks; ++task) {
        const auto path = folder.report_path(static_cast<std::int64_t>(task));
        auto report = read_task_report(path);
        while (!report && steady_seconds() < until) {
          wait(0.05);
          report = read_task_report(path);
        }
        if (!report) continue;
        Elsewhere& there = *options_.elsewhere;
        there.figures.cpu_s += report->cpu_s;
        there.figures.peak_resident = std::max(there.figures.peak_resident, report->peak_resident);
        there.nans.add(report->nans);
      }
  }

  void note_done(const std::vector<double>& weights) {
    for (const double weight : weights)
      if (options_.progress != nullptr) options_.progress->unit_done(weight);
  }

  void check_interrupt() const {
    if (options_.interrupt == nullptr || !options_.interrupt->requested()) return;
    spdlog::info(
        "the tasks submitted go on without this process; the same command goes on with them, "
        "`voxweld cancel CONFIG` ends them");
    throw Interrupted();
  }

  void wait(double seconds) const {
    const double until = steady_seconds() + seconds;
    while (steady_seconds() < until) {
      if (options_.interrupt != nullptr && options_.interrupt->requested()) return;
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
  }

  const SlurmSetup& setup_;
  SlurmClient& client_;
  const StageName stage_;
  const std::span<const Unit> units_;
  const RunOptions& options_;
  const std::filesystem::path parent_;
  UnitLedger ledger_;
  std::vector<std::pair<ArrayFolder, std::size_t>> arrays_;          // with their tasks
  std::vector<ArrayFolder> earlier_;                                 // of processes before this one
  std::map<std::string, std::string> names_;                         // of their jobs, by folder
  std::map<std::string, std::filesystem::file_time_type> reported_;  // when reports last came
  IdleWatch idle_watch_;
  double pause_s_ = 0.25;  // small volumes shall not wait for large ones' manners
};

}  // namespace

SlurmExecutor::SlurmExecutor(SlurmSetup setup, SlurmClient& client)
    : setup_(std::move(setup)), client_(client) {}

void SlurmExecutor::run_units(StageName stage, std::span<const Unit> units, const UnitWork&,
                              const RunOptions& options) {
  if (!options.done) throw std::logic_error(std::string(stage) + " cannot run elsewhere");
  StageOnSlurm(setup_, client_, stage, units, options).run();
}

}  // namespace voxweld
