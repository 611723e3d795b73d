// A histogram as a chart of a page.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "storage/types/histogram.h"
#include "storage/types/value_scale.h"

namespace voxweld {

struct ChartOptions {
  ValueScale scale;                // from samples to real values
  std::optional<double> isovalue;  // is marked, wherever it lies
  int bars = 160;                  // at most
};

struct HistogramChart {
  std::string html;       // empty where there is no finite sample
  double lo = 0, hi = 0;  // nearly all samples lie between, padding left out
};

// Bars on a logarithmic scale. Numbers stand beside the drawing as text of the page, so that they
// are as large on a narrow screen.
HistogramChart histogram_chart(const Histogram& histogram, const ChartOptions& options);

// Round numbers in [lo, hi], `most` at most.
std::vector<double> round_ticks(double lo, double hi, int most);

}  // namespace voxweld
