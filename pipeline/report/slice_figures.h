// The slices of a volume as figures of a page.
#pragma once

#include <optional>
#include <string>

#include "pipeline/report/volume_samples.h"
#include "storage/types/material_table.h"

namespace voxweld {

struct SliceStyle {
  Vec3 spacing{1, 1, 1}, first{};  // of samples, and where sample 0 lies
  std::string unit;
  double dark = 0, light = 1;      // values that are black and white
  std::optional<double> isovalue;  // its contour is drawn
  bool below = false;              // as contour_of
  // Of labels: their colours, and the one label that is meshed, if one is.
  MaterialTable colours;
  std::optional<Material> label;
};

// A picture of the samples with the contour over it, its sides as long as the spacing says.
std::string slice_figure(const Slice& slice, const SliceStyle& style);

// As CSS has it: "#rrggbb".
std::string css_colour(const MaterialTable& colours, Material label);

}  // namespace voxweld
