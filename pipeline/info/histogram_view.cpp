#include "pipeline/info/histogram_view.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "pipeline/info/facts.h"
#include "stages/ingest/histogram_values.h"
#include "storage/support/error.h"

namespace voxweld {
namespace {

nlohmann::ordered_json suggestion_json(const std::optional<IsovalueSuggestion>& suggestion,
                                       const char* clarity) {
  if (!suggestion) return nullptr;
  return {{"value", suggestion->threshold.value}, {clarity, suggestion->threshold.separability}};
}

std::optional<double> padding_of(const HistogramView& view) {
  if (view.otsu && view.otsu->padding) return view.otsu->padding;
  return view.valley ? view.valley->padding : std::nullopt;
}

// What stands beside the bar of the cell that holds it.
std::string marks(const HistogramView& view, std::size_t cell) {
  const double lo = view.cells.begin + view.cells.width * static_cast<double>(cell);
  std::string text;
  const auto mark = [&](const std::optional<IsovalueSuggestion>& suggestion, const char* name) {
    if (!suggestion) return;
    const double value = suggestion->threshold.value;
    if (value >= lo && value < lo + view.cells.width)
      text += fmt::format("  < {} {:.6g}", name, value);
  };
  mark(view.otsu, "otsu");
  mark(view.valley, "valley");
  return text;
}

std::string summary(const HistogramView& view) {
  std::string text;
  if (view.otsu)
    text += fmt::format("\"otsu\" is {:.6g} (separability {:.2f})\n", view.otsu->threshold.value,
                        view.otsu->threshold.separability);
  if (view.valley)
    text += fmt::format("\"valley\" is {:.6g} (depth {:.2f})\n", view.valley->threshold.value,
                        view.valley->threshold.separability);
  else if (view.otsu)
    text += "\"valley\": there is one peak, so none\n";
  if (const auto padding = padding_of(view))
    text += fmt::format("samples of {:.6g} are taken for padding and left out of both\n", *padding);
  return text;
}

}  // namespace

HistogramView view_histogram(const SampleSource& source, const std::string& path,
                             const HistogramOptions& options, const ScanHooks& hooks) {
  ScanResult scan = scan_in_order(source, hooks);
  HistogramView view;
  view.path = path;
  view.info = source.info();
  view.range = real_range(scan.range, view.info.scale);
  view.histogram = std::move(scan.histogram);
  const auto values = finite_values(view.histogram, view.info.scale);
  CellRange range = usual_range(values, options.cells);
  if (options.range) {
    range.lo = options.range->first;
    range.hi = options.range->second;
    if (!(range.hi > range.lo))
      throw InputError(fmt::format("--range {} {}: expected two numbers, the lower one first",
                                   range.lo, range.hi));
  }
  view.cells = cells_of(values, range);
  view.otsu = suggest_isovalue(view.histogram, view.info.scale, IsovalueRule::otsu);
  view.valley = suggest_isovalue(view.histogram, view.info.scale, IsovalueRule::valley);
  return view;
}

nlohmann::ordered_json to_json(const HistogramView& view) {
  const VolumeInfo& info = view.info;
  std::uint64_t samples = view.histogram.nans;
  for (const HistogramBin& bin : view.histogram.bins) samples += bin.count;
  nlohmann::ordered_json json = {{"path", view.path},
                                 {"format", info.format},
                                 {"size", facts_of(info.geometry.size)},
                                 {"type", sample_type_name(info.type)},
                                 {"slope", info.scale.slope},
                                 {"intercept", info.scale.intercept},
                                 {"samples", samples},
                                 {"nan_samples", view.histogram.nans},
                                 {"range", range_facts(view.range)}};
  json["cells"] = {{"begin", view.cells.begin},
                   {"width", view.cells.width},
                   {"counts", view.cells.counts},
                   {"below", view.cells.below},
                   {"above", view.cells.above}};
  json["otsu"] = suggestion_json(view.otsu, "separability");
  json["valley"] = suggestion_json(view.valley, "depth");
  json["padding"] = nullptr;
  if (const auto padding = padding_of(view)) json["padding"] = *padding;
  return json;
}

std::string to_text(const HistogramView& view, int columns) {
  constexpr int label = 12, count = 14, mark = 32, least_bar = 10;
  const int longest = std::max(least_bar, columns - label - count - mark);
  const Index3 size = view.info.geometry.size;
  std::string text = fmt::format("{}: {} x {} x {} {}", view.path, size.x, size.y, size.z,
                                 sample_type_name(view.info.type));
  if (!view.range.empty)
    text += fmt::format(", values {:.6g} to {:.6g}", view.range.lo, view.range.hi);
  if (view.histogram.nans > 0) text += fmt::format(", {} NaNs", view.histogram.nans);
  text += '\n';
  const std::vector<double>& counts = view.cells.counts;
  double highest = 1;
  for (const double c : counts) highest = std::max(highest, c);
  if (view.cells.below > 0) text += fmt::format("{:>12} {:.0f}\n", "below", view.cells.below);
  for (std::size_t i = 0; i < counts.size(); ++i) {
    const double center = view.cells.begin + view.cells.width * (static_cast<double>(i) + 0.5);
    const double share = std::log1p(counts[i]) / std::log1p(highest);
    const auto length = static_cast<std::size_t>(std::lround(longest * share));
    text += fmt::format("{:>12.6g} |{:<{}} {:.0f}{}\n", center, std::string(length, '#'), longest,
                        counts[i], marks(view, i));
  }
  if (view.cells.above > 0) text += fmt::format("{:>12} {:.0f}\n", "above", view.cells.above);
  return text + summary(view);
}

}  // namespace voxweld
