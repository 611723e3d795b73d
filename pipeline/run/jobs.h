// The stages' jobs of one config, wired to each other.
#pragma once

#include <optional>

#include "pipeline/encode/encode_stage.h"
#include "pipeline/ingest/ingest_stage.h"
#include "pipeline/run/output_frame.h"
#include "pipeline/stage/stage_jobs.h"
#include "storage/artifact/tolerance_artifact.h"
#include "storage/labels/label_map.h"

namespace voxweld {

class Jobs {
 public:
  // Opens the input and reads labels.map; throws what their readers throw. InputError where labels
  // are asked of samples that are none.
  // interrupt: as plan_ingest has it.
  explicit Jobs(const Config& config, const InterruptFlag* interrupt = nullptr);
  Jobs(const Jobs&) = delete;
  Jobs& operator=(const Jobs&) = delete;

  const IngestJob& ingest() const { return ingest_; }

  // Once ingest is current: opens its result, puts the chosen isovalue into `config` where it says
  // "otsu", the samples' noise and the size of tiles where these are "auto", and makes the later
  // jobs. Throws InputError where no isovalue can be chosen, no label is left, or no lattice planned.
  void open_volume(Config& config);

  // After open_volume, of a config whose sheets collapse by themselves: build cuts what a run with
  // the extraction's tolerance left, which is not larger.
  void cut(const Config& config, const Extraction& extraction);
  // After open_volume: build cuts what a run with a smaller tolerance left in the work folder, if there
  // is any. Where that is damaged or incomplete it reads samples.
  void cut_what_is_there(const Config& config);

  // After open_volume: part of what ingest leaves is missing.
  void build_what_is_there() { build_->partial_input = true; }

  // Which labels are meshed as far as that is known without counting them: sizes are not asked for.
  LabelParameters chosen_labels(const Config& config) const;
  // What labels.map says of materials besides: names and colours.
  const MaterialTable& materials() const { return map_.materials; }

  const Volume& volume() const { return build_->volume; }
  const BuildJob& build() const { return *build_; }
  const MergeJob& merge() const { return merge_; }
  const StitchJob& stitch() const { return stitch_; }
  // Of a config that refines.
  const RefineJob& refine() const { return refine_; }
  const RefineJob& seams() const { return seams_; }
  const RefineJob& mend() const { return mend_; }
  const RefineJob& remend() const { return remend_; }
  // Of one that asks for a number of triangles.
  const RefineJob& survey() const { return survey_; }
  const RefineJob& recount() const { return recount_; }
  // Once merge is current: cubes of refine that fit a number of triangles. vertices: as merge has them.
  void fit_cubes(const Config& config, std::uint64_t vertices);
  // Once it is chosen: that of refine, and recount after it, or of seams.
  void set_tolerance(Stage stage, double tolerance);
  const RetileJob& retile() const { return retile_; }
  // Of a config that has levels of detail.
  const LevelsJob& levels() const { return levels_; }
  const EncodeJob& encode() const { return encode_; }
  // Where the stages after ingest, as many as the config has, leave their artifacts.
  std::vector<std::filesystem::path> later_folders() const;

 private:
  void plan_refine(const Config& config, const OutputFrame& output);
  StagePaths paths_at(Config config, double tolerance) const;
  void cut_octrees(Config config, double tolerance, const StagePaths& paths);
  void place_stages(const StagePaths& paths);  // stitch and all behind it

  IngestJob ingest_;
  LabelMap map_;
  VolumeInfo output_info_;  // of the volume, with the geometry that the output has
  LabelParameters labels_;
  std::optional<BuildJob> build_, finer_;
  MergeJob merge_;
  StitchJob stitch_;
  RefineJob refine_, seams_, mend_, remend_, survey_, recount_;
  RetileJob retile_;
  LevelsJob levels_;
  EncodeJob encode_;
};

// Refuses, before any work, a run.memory that is too small for one unit of ingest or build.
void check_budget(const RunContext& context, const Jobs& jobs);

// What refine did to the mesh, in its passes.
struct RefineFigures {
  RefineCounts refine;
  std::vector<RefineCounts> later = {};  // of seams and mend, where there are any
  std::size_t first_patch = 0;  // of `later`: the first one that changed but some of the mesh
  std::optional<ChosenTolerance> target = {};  // of a config that asks for a number of triangles

  // Of the mesh as it is in the end.
  RefineCounts last() const {
    RefineCounts counts = first_patch == 0 ? refine : later[first_patch - 1];
    for (std::size_t i = first_patch; i < later.size(); ++i) counts = counts.patched_by(later[i]);
    return counts;
  }
};

// The manifest but for what encode adds. top: of these jobs; refined: of a config that refines.
Manifest make_manifest(const RunContext& context, const Jobs& jobs, const TopArtifact& top,
                       const std::optional<RefineFigures>& refined);

}  // namespace voxweld
