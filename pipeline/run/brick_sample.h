// A look at a few bricks of a volume, built as build would, to estimate what the whole will take.
#pragma once

#include <optional>

#include "pipeline/run/jobs.h"

namespace voxweld {

// Sums over the bricks looked at.
struct BrickSample {
  std::uint64_t bricks = 0, active = 0;
  std::uint64_t vertices = 0, polygons = 0;
  std::uint64_t octree_bytes = 0;  // of the artifact's parts
  double cpu_s = 0;                // building, reading not counted
  // The config's, or chosen from the samples seen; of solids alone none.
  std::optional<Isovalue> isovalue;  // of the file's real values
};

// The bricks that hold samples, a side: those of the ring alone are left out.
Index3 sampled_bricks(const BrickGrid& grid);

// Spread evenly over the volume, at most `most` of them, the same for the same volume. Nothing
// where the input is not read by boxes and has no brick store yet.
std::optional<BrickSample> sample_bricks(const RunContext& context, const Jobs& jobs,
                                         std::int64_t most);

}  // namespace voxweld
