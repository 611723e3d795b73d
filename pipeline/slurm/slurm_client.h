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

  friend bool operator==(const TaskState&, const TaskState&) = default;
};

// Why a pending task will not start however long one waits, with the keys of [slurm] to change;
// empty for a task that only waits its turn, or is not pending.
std::string standstill(const TaskState& task);

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

  // Submits the script with further arguments of sbatch and returns the job's id. Arguments win
  // over #SBATCH lines, and those over SBATCH_PARTITION and the like in the environment. The job is
  // named by `--job-name=`, in the arguments or else in the script, or else by the script's file,
  // with a unique ending: when an answer is lost, the job is looked for by it, so that nothing is
  // submitted twice. A stop or giving up while that is open cancels the job.
  // Throws InputError, with Slurm's words and the keys of [slurm] they are likely about, when the
  // cluster refuses what is asked for.
  std::int64_t submit(const std::filesystem::path& script, std::span<const std::string> arguments);

  // The tasks Slurm still knows of those jobs, one for each index of an array, in no order. Tasks
  // that are over are listed for some minutes; jobs that are forgotten are absent.
  std::vector<TaskState> tasks(std::span<const std::int64_t> jobs);

  // Ends the jobs and takes them from the queue; those that are over are no error. Works after a
  // stop was asked for; tries for half a minute at most.
  void cancel(std::span<const std::int64_t> jobs);

  // The same for single tasks of arrays: pairs of job and index.
  void cancel_tasks(std::span<const std::pair<std::int64_t, std::int64_t>> tasks);

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
  std::set<std::int64_t> jobs_named(const std::string& name, Patience& patience) const;
  void cancel_words(const std::vector<std::string>& words) const;
  void cancel_named(const std::string& name) const noexcept;

  SlurmClientOptions options_;
};

}  // namespace voxweld
