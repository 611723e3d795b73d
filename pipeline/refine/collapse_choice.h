// The tolerance of a pass of refine where a number of triangles is to be left: found by what survey
// or recount leaves, once for all units.
#pragma once

#include <optional>
#include <vector>

#include "pipeline/stage/stage_jobs.h"
#include "storage/artifact/tolerance_artifact.h"

namespace voxweld {

// Those a unit of survey or recount tries. Precondition of recount: its tolerance is refine's.
std::vector<double> tried_tolerances(const RefineJob& job);

// What a choice refers to, and outlives it.
struct ChoiceInputs {
  const RefineJob& job;                       // refine or seams, with a target
  const RefineJob& counted;                   // survey or recount
  std::vector<std::filesystem::path> counts;  // its artifacts
  std::optional<ChosenTolerance> first = {};  // of seams what was chosen for refine
};

class CollapseChoice {
 public:
  // Takes the one that lies in the job's folder where it is by these counts, and makes it else.
  // trust: it is by them, where there is one; a task among many does not look at all of them to know.
  // InputError where counts are missing.
  CollapseChoice(ChoiceInputs inputs, bool trust);

  const ChosenTolerance& chosen() const { return chosen_; }
  bool on_disk() const { return on_disk_; }
  void write();
  // Says what was chosen.
  void tell() const;

 private:
  struct Counted {
    CollapseSurvey survey;
    Hash128 contents;
  };
  Hash128 key() const;
  std::optional<ToleranceArtifact> find() const;
  Counted read_counts() const;
  void choose(const CollapseSurvey& survey);

  ChoiceInputs inputs_;
  ChosenTolerance chosen_;
  Hash128 contents_;
  bool on_disk_ = false;
};

}  // namespace voxweld
