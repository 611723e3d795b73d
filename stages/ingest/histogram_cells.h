// A histogram on cells of equal width, to look at and to find peaks in.
#pragma once

#include <span>
#include <vector>

#include "stages/ingest/histogram_values.h"

namespace voxweld {

struct CellRange {
  double lo = 0, hi = 0;  // values that the cells cover, hi at least lo
  int most = 256;         // cells, at least 2
};

struct HistogramCells {
  double begin = 0, width = 1;  // cell i covers [begin + i * width, begin + (i + 1) * width)
  std::vector<double> counts;   // a bin that lies in several cells is shared out evenly
  double below = 0, above = 0;  // samples outside of all cells
};

// All but the few outermost samples, which would leave the rest few cells. Precondition: ascending.
CellRange usual_range(std::span<const ValueCount> values, int most);

// Of values that are single numbers a cell is a whole number of steps wide and centred on them, for
// cells that hold now two and now three of them would look like peaks and valleys. None where the
// range is not finite. Precondition: ascending.
HistogramCells cells_of(std::span<const ValueCount> values, const CellRange& range);

}  // namespace voxweld
