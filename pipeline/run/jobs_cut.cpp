// Builds that cut what an earlier one of a smaller tolerance left.
#include <filesystem>

#include "pipeline/build/contour_parameters.h"
#include "pipeline/build/finer_build.h"
#include "pipeline/run/jobs.h"

namespace voxweld {

StagePaths Jobs::paths_at(Config config, double tolerance) const {
  config.simplify.tolerance = tolerance;
  return stage_paths(config, output_info_, labels_);
}

void Jobs::cut_octrees(Config config, double tolerance, const StagePaths& paths) {
  config.simplify.tolerance = tolerance;
  finer_ = *build_;
  finer_->folder = paths.build;
  finer_->key = paths.build_key;
  finer_->parameters.simplify.tolerance =
      absolute_tolerance(config, volume().source->info().geometry);
  build_->finer = &*finer_;
}

void Jobs::cut(const Config& config, const Extraction& extraction) {
  cut_octrees(config, extraction.tolerance, paths_at(config, extraction.tolerance));
  encode_.box = extraction.box;
}

void Jobs::cut_what_is_there(const Config& config) {
  if (!collapses_by_sheets(config)) return;
  for (const double tolerance : noted_tolerances(config.work.directory)) {
    if (!(tolerance < config.simplify.tolerance)) continue;
    const StagePaths paths = paths_at(config, tolerance);
    if (!std::filesystem::exists(paths.build)) continue;
    cut_octrees(config, tolerance, paths);
    build_->finer_may_fail = true;
    return;
  }
}

}  // namespace voxweld
