// The cluster as the pipeline sees it: submit a script, ask for its tasks, cancel them. Through
// Slurm's own programs, so that whatever version the cluster runs is spoken to as it wants to be.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "pipeline/executor/interrupt.h"
#include "pipeline/slurm/command.h"

namespace voxweld {

// One task of a job array, or a job that is no array.
struct TaskState {
  enum State : std::uint8_t {
    pending,     // waiting, held or requeued; `reason` says why
    running,     // has its node, suspended ones included
    completing,  // its processes are being ended
    gone,        // over, however it ended: slurm_state is COMPLETED, FAILED, NODE_FAIL ...
  };

  std::int64_t job = 0;
  std::int64_t task = -1;  // index in the array; -1: no array
  State state = pending;
  std::string slurm_state;  // Slurm's own word for it
  std::string reason;       // "None", "Resources", "DependencyNeverSatisfied" ...
  std::string node;         // empty before it runs
  std::string name;         // the job's: unique_job_name() of whoever submitted it

  friend bool operator==(const TaskState&, const TaskState&) = default;
};

// Why a pending task will not start however long one waits, with the keys of [slurm] to change;
// empty for a task that only waits its turn, or is not pending.
std::string standstill(const TaskState& task);

// "<base>-<16 hexadecimal digits>": a name no other job has, of characters that all of Slurm's
// programs take as they are. By it a job is known even when its id was lost, or given again.
std::string unique_job_name(const std::string& base);

struct SlurmClientOptions {
  std::chrono::milliseconds time_limit{120000};  // of one command; then it counts as no answer
  std::chrono::milliseconds patience{600000};    // how long to keep trying without an answer
  std::chrono::milliseconds pause{10000};        // between two tries; above 0
  // Waits that long; empty: really, looking at `interrupt` all the while.
  std::function<void(std::chrono::milliseconds)> sleep;
  const InterruptFlag* interrupt = nullptr;  // asked while waiting
};

// A controller that does not answer is waited for, with one warning, in every call. All calls
// throw InputError when Slurm's programs are missing or know no cluster, StorageError when nothing
// answers for `patience` or Slurm refuses in a way that is not the user's to mend, and (but for
// cancel) Interrupted when a stop is asked for while they wait.
class SlurmClient {
 public:
  explicit SlurmClient(SlurmClientOptions options = {});

  // Submits the script as a job of that name and returns its id. #SBATCH lines win over
  // SBATCH_PARTITION and the like in the environment. When an answer is lost, the job is looked for
  // by its name, so that nothing is submitted twice. A stop or giving up while that is open cancels
  // the job. Precondition: the name is from unique_job_name() and was given to no job before.
  // Throws InputError, with Slurm's words and the keys of [slurm] they are likely about, when the
  // cluster refuses what is asked for.
  std::int64_t submit(const std::filesystem::path& script, const std::string& name);

  // The tasks Slurm still knows of those jobs, one for each index of an array, in no order. Tasks
  // that are over are listed for some minutes; jobs that are forgotten are absent.
  std::vector<TaskState> tasks(std::span<const std::int64_t> jobs);

  // The same of this user's jobs of those names, whatever their ids.
  std::vector<TaskState> tasks_named(std::span<const std::string> names);

  // Ends the jobs and takes them from the queue; those that are over are no error. Works after a
  // stop was asked for; tries for half a minute at most.
  void cancel(std::span<const std::int64_t> jobs);

  // The same for single tasks of arrays: pairs of job and index.
  void cancel_tasks(std::span<const std::pair<std::int64_t, std::int64_t>> tasks);

  // Takes from the queue what waits there of this user's jobs of those names; what runs goes on.
  void cancel_pending(std::span<const std::string> names);

  // "slurm-wlm 22.05.8". To be called first: throws InputError, with what to do, when one of the
  // programs is missing.
  std::string version();

 private:
  class Patience;

  CommandResult run(std::span<const std::string> words) const;
  CommandResult run(std::span<const std::string> words,
                    const std::vector<std::string>& hidden) const;
  CommandResult ask(std::span<const std::string> words, Patience& patience) const;
  std::int64_t submit_named(std::span<const std::string> words, const std::string& name) const;
  std::vector<TaskState> named(std::span<const std::string> names, const std::string& states,
                               Patience& patience) const;
  std::set<std::int64_t> jobs_named(const std::string& name, Patience& patience) const;
  Patience short_patience() const;
  void cancel_words(const std::vector<std::string>& words, Patience& patience) const;
  void cancel_named(const std::string& name) const noexcept;

  SlurmClientOptions options_;
};

}  // namespace voxweld
