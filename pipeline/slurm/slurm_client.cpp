#include "pipeline/slurm/slurm_client.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <fstream>
#include <random>
#include <thread>

#include "pipeline/slurm/slurm_text.h"
#include "storage/support/error.h"

namespace voxweld {
namespace {

using std::chrono::milliseconds;
using Clock = std::chrono::steady_clock;
using Words = std::vector<std::string>;

constexpr milliseconds cancel_patience{30000};
constexpr milliseconds cancel_pause{2000};
constexpr std::size_t names_an_asking = 1000;  // the kernel takes 128 KiB a word

// Settings of the user's shell that would change what the programs do here: filters and formats of
// squeue and scancel, and what a script's own #SBATCH lines say but variables win over.
const Words& hidden_variables() {
  static const Words names = {"SQUEUE_",         "SCANCEL_",         "SLURM_CLUSTERS",
                              "SBATCH_CLUSTERS", "SBATCH_ARRAY_INX", "SBATCH_JOB_NAME",
                              "SBATCH_OUTPUT",   "SBATCH_ERROR",     "SBATCH_OPEN_MODE",
                              "SBATCH_WAIT",     "SBATCH_REQUEUE",   "SBATCH_NO_REQUEUE",
                              "SBATCH_MEM_PER_", "SBATCH_TIMELIMIT", "SBATCH_DEPENDENCY"};
  return names;
}

// What the script's own #SBATCH line says of an option such as "--qos="; empty where there is none.
std::string said_by(const std::filesystem::path& script, const std::string& option) {
  const std::string begin = "#SBATCH " + option;
  std::ifstream file(script);  // one that cannot be read is sbatch's to complain of
  for (std::string line; std::getline(file, line);)
    if (line.starts_with(begin)) return line.substr(begin.size());
  return {};
}

// With them, those that would win over what this script says.
Words hidden_variables(const std::filesystem::path& script) {
  Words names = hidden_variables();
  for (const auto& [option, variable] :
       {std::pair("--partition=", "SBATCH_PARTITION"), std::pair("--account=", "SBATCH_ACCOUNT"),
        std::pair("--qos=", "SBATCH_QOS")})
    if (!said_by(script, option).empty()) names.emplace_back(variable);
  return names;
}

std::string shown(milliseconds time) {
  if (time >= std::chrono::minutes(2)) return fmt::format("{} minutes", time.count() / 60000);
  if (time >= std::chrono::seconds(1)) return fmt::format("{} s", time.count() / 1000);
  return fmt::format("{} ms", time.count());
}

// Why there is no answer; empty when there is one.
std::string silence(const CommandResult& result, milliseconds time_limit) {
  if (result.timed_out) return fmt::format("no answer within {}", shown(time_limit));
  if (result.exit_code != 0 && slurm_text::is_unanswered(result.err))
    return slurm_text::said(result.err);
  return {};
}

[[noreturn]] void throw_refused(const std::string& program, const CommandResult& result) {
  const std::string words = slurm_text::said(result.err);
  const std::string keys = slurm_text::likely_setting(result.err);
  if (!keys.empty())
    throw InputError(fmt::format("{}: the cluster refuses the job: {}; this is likely about {}",
                                 program, words, keys));
  if (words.find("configuration source") != std::string::npos)
    throw InputError(
        fmt::format("{}: {}; run voxweld where the cluster's jobs are submitted, or "
                    "set run.executor = \"local\"",
                    program, words));
  throw StorageError(fmt::format("{} failed (exit code {}): {}", program, result.exit_code, words));
}

std::string id_list(std::span<const std::int64_t> jobs) {
  return fmt::format("{}", fmt::join(jobs, ","));
}

struct Standstill {
  const char* reason;
  const char* advice;
};

// Reasons that time alone does not take away. Other reasons are a matter of turn.
constexpr const char* too_large =
    "no node of the partition has what a task asks for: lower slurm.cpus_per_task or slurm.mem, or "
    "change slurm.partition or slurm.extra";
constexpr const char* too_long =
    "lower slurm.time, which is above the limit, or change slurm.partition or slurm.qos";
constexpr const char* held = "it is held: `scontrol release` lets it go";
constexpr std::array<Standstill, 12> standstills = {{
    {"PartitionTimeLimit", too_long},
    {"QOSMaxWallDurationPerJobLimit", too_long},
    {"AssocMaxWallDurationPerJobLimit", too_long},
    {"PartitionConfig", too_large},
    {"PartitionNodeLimit", too_large},
    {"BadConstraints", too_large},
    {"InvalidAccount", "change slurm.account"},
    {"InvalidQOS", "change slurm.qos"},
    {"JobHeldUser", held},
    {"JobHeldAdmin", held},
    {"held", held},  // "launch failed requeued held"
    {"DependencyNeverSatisfied", "what it waits for has failed"},
}};

}  // namespace

std::string unique_job_name(const std::string& base) {
  std::string name;
  for (const char c : base) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                       c == '.' || c == '-' || c == '_';
    name += plain ? c : '_';  // squeue reads a comma as the next name
  }
  std::random_device random;
  return fmt::format("{}-{:08x}{:08x}", name, random(), random());
}

std::string standstill(const TaskState& task) {
  if (task.state != TaskState::pending) return {};
  for (const Standstill& one : standstills)
    if (task.reason == one.reason || task.reason.ends_with(std::string(" ") + one.reason) ||
        task.reason.ends_with(std::string("_") + one.reason))
      return fmt::format("{}: {}", task.reason, one.advice);
  return {};
}

// How long one call has waited for an answer, and whether the user knows.
class SlurmClient::Patience {
 public:
  Patience(const SlurmClientOptions& options, milliseconds limit, milliseconds pause,
           const InterruptFlag* interrupt)
      : options_(options), limit_(limit), pause_(pause), interrupt_(interrupt) {}
  explicit Patience(const SlurmClientOptions& options)
      : Patience(options, options.patience, options.pause, options.interrupt) {}

  bool tried() const { return warned_; }
  // Waits before the next try. `why` is what was said in place of an answer.
  void wait(const std::string& why) {
    check_interrupt();
    if (!warned_)
      spdlog::warn("Slurm does not answer: {}; asking again for up to {}", why, shown(limit_));
    warned_ = true;
    // Both are counted: tries that hang take longer than the pauses between them.
    if (waited_ >= limit_ || Clock::now() - begin_ >= limit_)
      throw StorageError(
          fmt::format("Slurm has not answered for {}: {}; what is finished is kept, run the same "
                      "command again when the cluster answers",
                      shown(limit_), why));
    rest();
  }
  void rest() {
    sleep();
    waited_ += pause_;
    check_interrupt();
  }

 private:
  void check_interrupt() const {
    if (interrupt_ != nullptr) interrupt_->check();
  }
  void sleep() const {
    if (options_.sleep) return options_.sleep(pause_);
    constexpr milliseconds slice{100};
    for (const auto end = Clock::now() + pause_; Clock::now() < end; check_interrupt())
      std::this_thread::sleep_for(std::min(slice, pause_));
  }

  const SlurmClientOptions& options_;
  milliseconds limit_, pause_;
  const InterruptFlag* interrupt_;
  Clock::time_point begin_ = Clock::now();
  milliseconds waited_{0};
  bool warned_ = false;
};

SlurmClient::SlurmClient(SlurmClientOptions options) : options_(std::move(options)) {}

CommandResult SlurmClient::run(std::span<const std::string> words) const {
  return run(words, hidden_variables());
}

CommandResult SlurmClient::run(std::span<const std::string> words,
                               const std::vector<std::string>& hidden) const {
  CommandOptions options;
  options.time_limit = options_.time_limit;
  options.hidden_variables = hidden;
  spdlog::debug("{}", fmt::join(words, " "));
  try {
    return run_command(words, options);
  } catch (const StorageError& error) {
    if (error.error_number() != ENOENT) throw;
    throw InputError(fmt::format(
        "{}; run.executor = \"slurm\" needs Slurm's sbatch, squeue and scancel on PATH: "
        "run voxweld on a login node of the cluster, or set run.executor = \"local\"",
        error.what()));
  }
}

// The answer to a question that may be asked again: of any exit code, but never a silence.
CommandResult SlurmClient::ask(std::span<const std::string> words, Patience& patience) const {
  for (;;) {
    CommandResult result = run(words);
    const std::string why = silence(result, options_.time_limit);
    if (why.empty()) return result;
    patience.wait(why);
  }
}

// Of this user's jobs of those names; states as `squeue -t` takes them.
std::vector<TaskState> SlurmClient::named(std::span<const std::string> names,
                                          const std::string& states, Patience& patience) const {
  std::vector<TaskState> all;
  while (!names.empty()) {
    const auto some = names.first(std::min(names.size(), names_an_asking));
    names = names.subspan(some.size());
    const Words words = {"squeue",
                         "-h",
                         "-r",
                         "-t",
                         states,
                         fmt::format("--user={}", geteuid()),
                         fmt::format("--name={}", fmt::join(some, ",")),
                         "-o",
                         slurm_text::task_format};
    const CommandResult result = ask(words, patience);
    if (result.exit_code != 0) throw_refused("squeue", result);
    for (TaskState& task : slurm_text::parse_tasks(result.out)) all.push_back(std::move(task));
  }
  return all;
}

std::set<std::int64_t> SlurmClient::jobs_named(const std::string& name, Patience& patience) const {
  std::set<std::int64_t> jobs;  // an array has several lines
  for (const TaskState& task : named({&name, 1}, "all", patience)) jobs.insert(task.job);
  return jobs;
}

// Precondition: the script is the last word.
std::int64_t SlurmClient::submit_named(std::span<const std::string> words,
                                       const std::string& name) const {
  Patience patience(options_);
  const Words hidden = hidden_variables(words.back());
  for (;;) {
    const CommandResult result = run(words, hidden);
    const std::string why = silence(result, options_.time_limit);
    const auto job = slurm_text::submitted_job(result.out);
    if (why.empty() && result.exit_code != 0) throw_refused("sbatch", result);
    if (why.empty() && !job)
      throw StorageError(
          fmt::format("sbatch: expected a job id, found \"{}\"", slurm_text::said(result.out)));
    if (why.empty() && !patience.tried()) return *job;

    // An earlier try may have got through although its answer did not, and after this one too.
    if (!why.empty()) patience.wait(why);
    std::set<std::int64_t> there = jobs_named(name, patience);
    if (there.empty() && !job) {
      // A controller that is back answers questions before it has worked through its backlog.
      patience.rest();
      there = jobs_named(name, patience);
    }
    if (job) there.insert(*job);
    if (there.empty()) continue;
    const std::int64_t first = *there.begin();
    there.erase(first);
    for (const std::int64_t twin : there) {
      spdlog::warn("Slurm took job {} twice; {} is cancelled", first, twin);
      run(Words{"scancel", std::to_string(twin)});
    }
    return first;
  }
}

// As well as one try can: it runs while another error is on its way.
void SlurmClient::cancel_named(const std::string& name) const noexcept {
  try {
    run(Words{"scancel", "--name=" + name});
  } catch (...) {
  }
}

std::int64_t SlurmClient::submit(const std::filesystem::path& script, const std::string& name) {
  if (options_.interrupt != nullptr) options_.interrupt->check();
  const Words words = {"sbatch", "--parsable", "--job-name=" + name, script.string()};
  try {
    return submit_named(words, name);
  } catch (const Interrupted&) {
    cancel_named(name);
    throw;
  } catch (const StorageError&) {
    cancel_named(name);
    throw;
  }
}

std::vector<TaskState> SlurmClient::tasks(std::span<const std::int64_t> jobs) {
  if (jobs.empty()) return {};
  Patience patience(options_);
  const Words words = {
      "squeue", "-h", "-r", "-t", "all", "-j", id_list(jobs), "-o", slurm_text::task_format};
  const CommandResult result = ask(words, patience);
  if (result.exit_code == 0) return slurm_text::parse_tasks(result.out);
  if (!slurm_text::is_unknown_job(result.err)) throw_refused("squeue", result);
  // One that is forgotten must not hide the others.
  std::vector<TaskState> all;
  if (jobs.size() > 1)
    for (const std::int64_t job : jobs)
      for (TaskState& task : tasks({&job, 1})) all.push_back(std::move(task));
  return all;
}

std::vector<TaskState> SlurmClient::tasks_named(std::span<const std::string> names) {
  Patience patience(options_);
  return named(names, "all", patience);
}

void SlurmClient::cancel(std::span<const std::int64_t> jobs) {
  if (jobs.empty()) return;
  Words words = {"scancel"};
  for (const std::int64_t job : jobs) words.push_back(std::to_string(job));
  Patience patience = short_patience();
  cancel_words(words, patience);
}

void SlurmClient::cancel_tasks(std::span<const std::pair<std::int64_t, std::int64_t>> tasks) {
  if (tasks.empty()) return;
  Words words = {"scancel"};
  for (const auto& [job, task] : tasks) words.push_back(fmt::format("{}_{}", job, task));
  Patience patience = short_patience();
  cancel_words(words, patience);
}

void SlurmClient::cancel_pending(std::span<const std::string> names) {
  Patience patience = short_patience();
  std::set<std::string> waiting;
  for (const TaskState& task : named(names, "PENDING", patience)) waiting.insert(task.name);
  for (const std::string& name : waiting)
    cancel_words(
        Words{"scancel", "--state=PENDING", fmt::format("--user={}", geteuid()), "--name=" + name},
        patience);
}

// Of what also has to work after a stop was asked for.
SlurmClient::Patience SlurmClient::short_patience() const {
  return {options_, std::min(options_.patience, cancel_patience),
          std::min(options_.pause, cancel_pause), nullptr};
}

void SlurmClient::cancel_words(const std::vector<std::string>& words, Patience& patience) const {
  const CommandResult result = ask(words, patience);
  if (result.exit_code != 0 && !slurm_text::is_unknown_job(result.err))
    throw StorageError(fmt::format("scancel failed: {}; cancel by hand: {}",
                                   slurm_text::said(result.err), fmt::join(words, " ")));
}

std::string SlurmClient::version() {
  std::string first;
  for (const char* program : {"sbatch", "squeue", "scancel"}) {
    const CommandResult result = run(Words{program, "--version"});
    if (result.timed_out || result.exit_code != 0) throw_refused(program, result);
    if (first.empty()) first = result.out.substr(0, result.out.find('\n'));
  }
  return first;
}

}  // namespace voxweld
