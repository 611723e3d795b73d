// What refine, seams, mend and remend take as one unit of merge's plan: a range of cubes, of one surface or of one
// label, or small labels whole.
#pragma once

#include <string>
#include <vector>

#include "stages/refine/cube_ranges.h"
#include "storage/artifact/top_artifact.h"
#include "storage/types/material.h"

namespace voxweld {

struct RefineUnit {
  // In these cubes the surfaces of these labels; of one surface, label 0.
  PlannedRange range;
  Material first_label = 0, end_label = 1;
  std::uint64_t labels = 0;  // how many are planned; 0: one surface
  bool whole = false;        // all cubes

  bool of_labels() const { return labels > 0; }
  std::string name() const;  // "cubes from 0-1-0 on", "12 labels from 7 on"
};

// By label and then by cubes. mode: of the run that made the top tree.
std::vector<RefineUnit> refine_units(const TopArtifact& top, LabelMode mode,
                                     const CubeGrid& cubes = {});

}  // namespace voxweld
