// What all stages of a run share: the config, the executor, and how units are run.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/config/config.h"
#include "pipeline/executor/executor.h"
#include "pipeline/executor/memory_budget.h"
#include "pipeline/executor/progress.h"
#include "pipeline/stage/unit_selection.h"
#include "stages/solids/solid.h"
#include "storage/types/nan_count.h"

namespace voxweld {

// What a stage did, for the manifest and the summary.
struct StageReport {
  std::string stage;
  std::uint64_t units = 0;  // in all
  std::uint64_t ran = 0;    // those that were missing
  StageFigures figures;
};

// Of the shards that build worked on, in this process.
struct BrickReport {
  std::uint64_t built = 0;
  std::uint64_t kept = 0;       // as they were before the edits changed
  std::uint64_t cut = 0;        // from octrees of a smaller tolerance
  std::uint64_t bytes_cut = 0;  // read of these
  std::uint64_t unread = 0;     // without a surface, as a build before has found
  BrickReport& operator+=(const BrickReport& other) {
    built += other.built;
    kept += other.kept;
    cut += other.cut;
    bytes_cut += other.bytes_cut;
    unread += other.unread;
    return *this;
  }
};

class DirectoryLock;

// What is made is a cut of what a run of the same config left at a smaller tolerance.
struct Extraction {
  double tolerance = 0;       // simplify.tolerance of that run
  std::optional<Bounds> box;  // of the merged mesh only what reaches in; in its coordinates
};

struct RunContext {
  Config config;
  std::filesystem::path config_file;  // absolute; the output directory is this one's
  // result_hash of that file alone; nothing where it is no whole config without its overrides.
  std::optional<Hash128> config_result;
  std::optional<Extraction> extraction;
  bool force = false;                   // whatever is in the output directory may be written over
  const DirectoryLock* lock = nullptr;  // of the output directory, while this process has it
  Executor* executor = nullptr;
  std::shared_ptr<Console> console;
  ProgressSettings progress;
  const InterruptFlag* interrupt = nullptr;
  int threads = 1;          // as the config has it, resolved
  UnitSelection selection;  // the units to do, where this is one task of several
  bool inputs_checked =
      false;  // the stages before are known to be complete: no look at all of them
  std::function<void()> check_input;  // as RunOptions has it
  std::vector<StageReport> reports;
  BrickReport bricks;
  NanCount nans;  // among the samples that the stage under way has read, here or elsewhere

  MemoryBudget budget() const { return {config.run.memory}; }
};

// What the program itself has resident before any unit runs, with room for the allocator's slack:
// more once the image module is loaded, which takes 120 MiB. Gives what lies free back to the system
// first, unless the whole process has less than a 32nd of `memory` resident: to unmap pages and to map
// them again takes some ms.
std::uint64_t program_bytes(std::uint64_t memory = 0);

// Tells the user of NaNs among the samples a stage has read, if there are any: a warning.
void warn_of_nans(const Config& config, const NanCount& nans);

// One stage's units on the executor, measured and shown; appends to context.reports.
struct StageRun {
  std::string stage;   // "build"
  std::string noun;    // "shards"
  StageMemory memory;  // base_bytes: beside the program itself
  // What a unit takes of what they share, set aside while it is under way. Empty: nothing, its work
  // asks by itself (WorkerContext::memory).
  std::function<std::uint64_t(const Unit&)> bytes;
  std::uint64_t reused = 0;
  bool apart_reused = false;  // one of them is the unit that is apart
  UnitOrder order = UnitOrder::largest_first;
  std::function<bool(const Unit&)> done;  // as RunOptions has them
  std::string identity;
};
// How many workers fit run.memory at once: the slots the work may see, scratch for each.
// InputError where not even one does.
int stage_threads(const RunContext& context, StageMemory memory);
void run_stage(RunContext& context, const StageRun& stage, const std::vector<Unit>& units,
               int threads, const UnitWork& work);

}  // namespace voxweld
