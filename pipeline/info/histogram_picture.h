// A histogram as a picture: bars on a logarithmic scale, the suggested isovalues as lines.
#pragma once

#include <cstdint>
#include <vector>

#include "pipeline/info/histogram_view.h"

namespace voxweld {

struct HistogramPicture {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgb;  // rows from the top, three bytes a pixel
};

// Preconditions: width at least 320, height at least 200.
HistogramPicture draw_histogram(const HistogramView& view, int width, int height);

}  // namespace voxweld
