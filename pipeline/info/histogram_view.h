// A volume's histogram as `voxweld histogram` shows it.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>

#include "pipeline/info/value_scan.h"
#include "stages/ingest/histogram_cells.h"
#include "stages/ingest/threshold.h"
#include "storage/types/volume.h"

namespace voxweld {

struct HistogramOptions {
  int cells = 256;                                   // at most
  std::optional<std::pair<double, double>> range{};  // real values; else all but the outermost
};

struct HistogramView {
  std::string path;
  VolumeInfo info;
  Histogram histogram;
  ValueRange range;  // of all samples, in real values
  HistogramCells cells;
  std::optional<IsovalueSuggestion> otsu, valley;
};

// Reads all samples. Throws what scan_in_order throws; InputError where the range is empty.
HistogramView view_histogram(const SampleSource& source, const std::string& path,
                             const HistogramOptions& options, const ScanHooks& hooks);

// Keys: path, format, size, type, slope, intercept, samples, nan_samples, range [lo, hi], cells
// {begin, width, counts, below, above}, otsu {value, separability} or null, valley {value, depth} or
// null, padding (left out by both) or null. Values are real ones.
nlohmann::ordered_json to_json(const HistogramView& view);

// Bars of characters, a line for each of the cells, on a logarithmic scale, with the suggested
// isovalues beside them. columns: of the terminal.
std::string to_text(const HistogramView& view, int columns);

}  // namespace voxweld
