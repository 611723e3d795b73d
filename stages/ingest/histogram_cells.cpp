#include "stages/ingest/histogram_cells.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace voxweld {
namespace {

double cell_width(std::span<const ValueCount> values, const CellRange& range) {
  double step = 0;  // the narrowest bin
  for (const ValueCount& v : values)
    if (v.hi > v.lo && (step == 0 || v.hi - v.lo < step)) step = v.hi - v.lo;
  const double width = (range.hi - range.lo) / (range.most - 1);
  return step > 0 ? step * std::max(1.0, std::ceil(width / step)) : width;
}

// The bin's count, spread evenly over what it covers.
void spread(const ValueCount& v, HistogramCells& cells) {
  const auto count = static_cast<double>(cells.counts.size());
  const double a = (v.lo - cells.begin) / cells.width, b = (v.hi - cells.begin) / cells.width;
  const double length = b - a;
  if (!(length > 0)) {
    if (a < 0)
      cells.below += v.count;
    else if (a >= count)
      cells.above += v.count;
    else
      cells.counts[static_cast<std::size_t>(a)] += v.count;
    return;
  }
  const auto share = [&](double from, double to) {
    return std::max(0.0, std::min(b, to) - std::max(a, from)) / length * v.count;
  };
  cells.below += a < 0 ? share(a, 0) : 0;
  cells.above += b > count ? share(count, b) : 0;
  const auto first = static_cast<std::size_t>(std::clamp(std::floor(a), 0.0, count));
  const auto end = static_cast<std::size_t>(std::clamp(std::ceil(b), 0.0, count));
  for (std::size_t i = first; i < end; ++i)
    cells.counts[i] += share(static_cast<double>(i), static_cast<double>(i) + 1);
}

}  // namespace

CellRange usual_range(std::span<const ValueCount> values, int most) {
  constexpr double outliers = 0.0005;
  const auto lo = quantile_of(values, outliers), hi = quantile_of(values, 1 - outliers);
  if (!lo) return {0, 0, most};
  if (*hi > *lo) return {*lo, *hi, most};
  return {values.front().value, values.back().value, most};
}

HistogramCells cells_of(std::span<const ValueCount> values, const CellRange& range) {
  HistogramCells cells;
  const double width = cell_width(values, range);
  const double count = width > 0 ? std::floor((range.hi - range.lo) / width) + 1 : 1;
  if (!std::isfinite(count) || !std::isfinite(range.lo)) return cells;
  cells.width = width > 0 ? width : 1;
  cells.begin = range.lo - cells.width / 2;
  cells.counts.resize(static_cast<std::size_t>(count));
  for (const ValueCount& v : values) spread(v, cells);
  return cells;
}

}  // namespace voxweld
