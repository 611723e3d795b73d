#include "stages/ingest/valley.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <utility>
#include <vector>

#include "stages/ingest/histogram_cells.h"

namespace voxweld {
namespace {

constexpr int most_cells = 256;
constexpr int smoothing_passes = 8;  // of 1 2 1: a Gaussian of 2 cells
// The least persistence of a peak: in roots of counts, whose noise is half of one before they are
// smoothed, and as a share of the highest peak's.
constexpr double least_persistence = 3, least_share = 0.02;

std::optional<HistogramCells> lay_out(std::span<const ValueCount> values) {
  if (values.size() < 2) return std::nullopt;
  HistogramCells cells = cells_of(values, usual_range(values, most_cells));
  constexpr std::size_t least_cells = 3;
  if (cells.counts.size() < least_cells) return std::nullopt;
  return cells;
}

void smooth(std::vector<double>& counts) {
  std::vector<double> next(counts.size());
  for (int pass = 0; pass < smoothing_passes; ++pass) {
    for (std::size_t i = 0; i < counts.size(); ++i) {
      const double left = counts[i == 0 ? 0 : i - 1];
      const double right = counts[i + 1 == counts.size() ? i : i + 1];
      next[i] = 0.25 * left + 0.5 * counts[i] + 0.25 * right;
    }
    counts.swap(next);
  }
}

struct Peak {
  std::size_t cell;
  double persistence;
};

// All peaks, the one that lasts longest first. Cells join from the highest down; where two groups
// meet, the lower peak's life ends.
std::vector<Peak> peaks_of(const std::vector<double>& heights) {
  const std::size_t none = heights.size();
  std::vector<std::size_t> order(heights.size()), group(heights.size(), none);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, [&](auto a, auto b) { return heights[a] > heights[b]; });
  const auto top = [&](std::size_t cell) {  // the highest of its group
    while (group[cell] != cell) cell = group[cell] = group[group[cell]];
    return cell;
  };
  std::vector<Peak> peaks;
  for (const std::size_t cell : order) {
    group[cell] = cell;
    for (const std::size_t neighbour : {cell - 1, cell + 1}) {
      if (neighbour >= heights.size() || group[neighbour] == none) continue;
      std::size_t high = top(cell), low = top(neighbour);
      if (high == low) continue;
      if (heights[low] > heights[high]) std::swap(low, high);
      if (low != cell) peaks.push_back({low, heights[low] - heights[cell]});
      group[low] = high;
    }
  }
  if (!order.empty()) peaks.push_back({order.front(), heights[order.front()]});
  std::ranges::stable_sort(peaks, [](auto& a, auto& b) { return a.persistence > b.persistence; });
  return peaks;
}

}  // namespace

std::optional<Threshold> deepest_valley(std::span<const ValueCount> values) {
  std::optional<HistogramCells> cells = lay_out(values);
  if (!cells) return std::nullopt;
  smooth(cells->counts);
  std::vector<double>& heights = cells->counts;
  for (double& height : heights) height = std::sqrt(height);
  const std::vector<Peak> peaks = peaks_of(heights);
  if (peaks.size() < 2) return std::nullopt;
  const double highest = std::ranges::max(heights);
  if (peaks[1].persistence < std::max(least_persistence, least_share * highest))
    return std::nullopt;
  const auto [first, last] = std::minmax(peaks[0].cell, peaks[1].cell);
  const auto begin = heights.begin() + static_cast<std::ptrdiff_t>(first);
  const auto end = heights.begin() + static_cast<std::ptrdiff_t>(last);
  const auto lowest = std::min_element(begin, end);
  // An empty stretch is cut in its middle.
  const auto rise = std::find_if(lowest, end, [&](double height) { return height > *lowest; });
  const auto middle =
      static_cast<double>((lowest - heights.begin()) + (rise - heights.begin()) - 1);
  const double share = *lowest / std::min(heights[first], heights[last]);
  return Threshold{cells->begin + cells->width * (middle / 2 + 0.5), 1 - share * share};
}

}  // namespace voxweld
