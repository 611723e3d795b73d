// The protocol of a stage: its units, which of them are missing and why, what one takes, doing one.
// `run`, single stages, `--dry-run`, `status`, shares of a stage and Slurm are loops over it
// (pipeline/run), so that a new stage or a new kind of unit is one class.
#pragma once

#include <memory>
#include <optional>
#include <span>

#include "pipeline/config/settings.h"
#include "pipeline/stage/context.h"

namespace voxweld {

// What the command line calls a stage's units: "shards", "tiles", or "ranges" of cubes.
const char* unit_option(Stage stage);

// What of a stage is there.
struct StageLook {
  std::uint64_t units = 0;             // in all
  std::vector<std::uint64_t> missing;  // of those looked at, ascending
  // There, but perhaps of other inputs: StageWork::prove tells.
  std::vector<std::uint64_t> unproven;
  std::string rest;  // what of the whole stage is missing beside its units; empty: nothing

  bool current() const { return missing.empty() && unproven.empty() && rest.empty(); }
  std::vector<std::uint64_t> to_do() const;  // the missing and the unproven, ascending
};

// One stage of one config. Preconditions: the stages before it are current; what it refers to
// outlives it.
class StageWork {
 public:
  virtual ~StageWork() = default;

  virtual Stage stage() const = 0;
  virtual std::string noun() const = 0;  // of its units, for people: "shards"
  // Names the work for an executor elsewhere, as RunOptions::identity.
  virtual std::string identity() const = 0;

  // Units are numbered from 0 in an order that depends on the volume and the config alone.
  virtual std::uint64_t size() const = 0;
  // Ascending numbers, the last of them size(): units below each are done before the others are begun.
  virtual std::vector<std::uint64_t> rounds() const { return {size()}; }
  // The one that people do not count among them, as Unit::apart, where there is one.
  virtual std::optional<std::uint64_t> apart() const { return std::nullopt; }
  // Their names and weights, in the order of the numbers. Precondition: these ascend.
  virtual std::vector<Unit> units(std::span<const std::uint64_t> numbers) const = 0;
  // Whether the unit's result is there and whole, whoever made it. Thread-safe; reads no samples.
  virtual bool done(std::uint64_t unit) = 0;
  // Of the selected units.
  virtual StageLook look(const UnitSelection& selection);
  // In words, for --dry-run: "3 of 8 shards missing". Of a look that is not current.
  virtual std::string missing_text(const StageLook& look) const;
  // For --dry-run, where nothing is missing.
  virtual std::string current_text() const { return "up to date"; }
  // Looks closer at what is unproven; afterwards nothing is.
  virtual void prove(RunContext&, StageLook&) {}

  // What workers and the largest of these units take.
  virtual StageMemory memory(std::span<const std::uint64_t> numbers) = 0;
  // What one unit takes of what the units share. 0: its work asks by itself.
  virtual std::uint64_t bytes(std::uint64_t) { return 0; }
  virtual UnitOrder order() const { return UnitOrder::largest_first; }

  // In the process that does the work: scratch for each worker before, figures after.
  virtual void begin(RunContext&, std::span<const std::uint64_t>, int) {}
  virtual void run(const Unit& unit, WorkerContext& worker) = 0;
  virtual void end(RunContext&) {}
  // Throws InputError for what open() would refuse; for --dry-run, which opens nothing.
  virtual void check(const RunContext&, const StageLook&) const {}
  // Before and after all units, in the process that leads: what belongs to the stage as a whole.
  virtual void open(RunContext&, const StageLook&) {}
  virtual void close(RunContext&) {}

 protected:
  // Of these units what the largest takes, as bytes().
  std::uint64_t largest_bytes(std::span<const std::uint64_t> numbers);
};

// Does all that is missing of the units context selects and, where it selects all, of the rest.
void do_stage(RunContext& context, StageWork& work);

}  // namespace voxweld
