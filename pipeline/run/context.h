// What all stages of a run share: the config, where things lie, and how units are run.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "pipeline/config/config.h"
#include "pipeline/executor/executor.h"
#include "pipeline/executor/memory_budget.h"
#include "pipeline/executor/progress.h"
#include "pipeline/run/unit_selection.h"
#include "stages/geometry/brick_grid.h"
#include "stages/geometry/parameters.h"
#include "storage/support/hash.h"
#include "storage/types/output_lattice.h"
#include "storage/types/volume.h"

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
  std::uint64_t kept = 0;  // as they were before the edits changed
  BrickReport& operator+=(const BrickReport& other) {
    built += other.built;
    kept += other.kept;
    return *this;
  }
};

struct RunContext {
  Config config;
  Executor* executor = nullptr;
  std::shared_ptr<Console> console;
  ProgressSettings progress;
  const InterruptFlag* interrupt = nullptr;
  int threads = 1;          // as the config has it, resolved
  UnitSelection selection;  // the units to do, where this is one task of several
  bool inputs_checked =
      false;  // the stages before are known to be complete: no look at all of them
  std::vector<StageReport> reports;
  BrickReport bricks;

  MemoryBudget budget() const { return {config.run.memory}; }
};

// What the program itself has resident before any unit runs, with room for the allocator's slack:
// more once the image module is loaded, which takes 120 MiB.
std::uint64_t program_bytes();

// One stage's units on the executor, measured and shown; appends to context.reports.
struct StageRun {
  std::string stage;   // "build"
  std::string noun;    // "shards"
  StageMemory memory;  // base_bytes is filled in
  std::uint64_t reused = 0;
  UnitOrder order = UnitOrder::largest_first;
  std::function<bool(const Unit&)> done;  // as RunOptions has them
  std::string identity;
};
// How many units fit run.memory at once: the worker slots the work may see, scratch for each.
int stage_threads(const RunContext& context, StageMemory memory);
void run_stage(RunContext& context, const StageRun& stage, const std::vector<Unit>& units,
               int threads, const UnitWork& work);

// The volume as the stages read it: by boxes, from any thread.
struct Volume {
  std::shared_ptr<const SampleSource> source;
  const RangedSource* ranges = nullptr;  // the same source when it knows ranges
  // Of what the samples of a box come from: equal when nothing hints at a change there (names,
  // sizes and times of files, hashes of a store's shards).
  std::function<Hash128(const Box3& samples)> stamp;
  const VolumeGeometry& geometry() const { return source->info().geometry; }
};

// The contouring parameters the config asks for on this volume. Precondition: the isovalue is
// resolved; `labels` are of the same config.
ContourParameters contour_parameters(const Config& config, const SampleSource& source,
                                     LabelParameters labels);
BrickGrid brick_grid(const Config& config, const VolumeGeometry& geometry);
double smallest_spacing(const VolumeGeometry& geometry);

// That of the files: as it is where floats hold its coordinates on this lattice; else, of meshes
// far from 0, such that the volume's first sample is at 0 and the rest is left to `origin`.
VolumeGeometry output_geometry(const VolumeGeometry& geometry, const OutputLattice& lattice);

// Folders of a run's artifacts, each named for what its stage and those before it read.
struct StagePaths {
  std::filesystem::path ingest, build, merge, stitch, encode;
  Hash128 build_key, merge_key, stitch_key, encode_key;  // parameters, all stages before included
};
// info: with output_geometry; for the ingest folder alone it is not looked at.
StagePaths stage_paths(const Config& config, const VolumeInfo& info, const LabelParameters& labels);

std::string short_hex(Hash128 hash);  // 12 digits
// "<x>-<y>-<z>" and a folder for it that keeps every folder small.
std::filesystem::path fanned_out(const std::filesystem::path& root, Index3 at,
                                 const std::string& name);

}  // namespace voxweld
