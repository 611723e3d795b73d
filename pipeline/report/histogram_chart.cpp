#include "pipeline/report/histogram_chart.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "pipeline/report/html_text.h"
#include "stages/ingest/histogram_cells.h"
#include "stages/ingest/histogram_values.h"
#include "stages/ingest/threshold.h"

namespace voxweld {
namespace {

constexpr int height = 1000;

// One path for all bars, in cells along x.
std::string bars_path(const std::vector<double>& counts) {
  double highest = 1;
  for (const double count : counts) highest = std::max(highest, count);
  std::string path;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    const auto tall = std::llround(height * std::log1p(counts[i]) / std::log1p(highest));
    if (tall > 0) path += fmt::format("M{} {}v{}h1v{}z", i, height, -tall, tall);
  }
  return path;
}

struct Along {
  double begin = 0, end = 1;
  double percent(double value) const {
    return std::clamp(100 * (value - begin) / (end - begin), 0.0, 100.0);
  }
};

std::string ticks_html(const Along& along) {
  std::string html;
  for (const double tick : round_ticks(along.begin, along.end, 6)) {
    const double at = along.percent(tick);
    if (at < 2 || at > 98) continue;  // it would reach over the edge
    html += fmt::format("<span class=\"tick\" style=\"left:{:.2f}%\">{}</span>", at,
                        short_number(tick));
  }
  return html;
}

std::string mark_html(const Along& along, double isovalue) {
  const double at = along.percent(isovalue);
  // The text stands on the side with more room.
  return fmt::format("<span class=\"mark{}\" style=\"left:{:.2f}%\">isovalue {:.7g}</span>",
                     at > 50 ? " left" : "", at, isovalue);
}

// What scanners write outside their field of view would leave few greys for the rest.
std::vector<ValueCount> without_padding(std::vector<ValueCount> values, const Histogram& histogram,
                                        const ValueScale& scale) {
  const auto suggestion = suggest_isovalue(histogram, scale);
  if (suggestion && suggestion->padding)
    std::erase_if(values, [&](const ValueCount& v) { return v.value == *suggestion->padding; });
  return values;
}

}  // namespace

std::vector<double> round_ticks(double lo, double hi, int most) {
  std::vector<double> ticks;
  if (!(hi > lo) || !std::isfinite(lo) || !std::isfinite(hi)) return ticks;
  const double rough = (hi - lo) / most;
  const double power = std::pow(10, std::floor(std::log10(rough)));
  const double step = power * (rough <= power       ? 1
                               : rough <= 2 * power ? 2
                               : rough <= 5 * power ? 5
                                                    : 10);
  for (double i = std::ceil(lo / step); i * step <= hi; ++i) ticks.push_back(i * step + 0.0);
  return ticks;
}

HistogramChart histogram_chart(const Histogram& histogram, const ChartOptions& options) {
  HistogramChart chart;
  const auto values = finite_values(histogram, options.scale);
  if (values.empty()) return chart;
  CellRange range = usual_range(values, options.bars);
  const CellRange shown = usual_range(without_padding(values, histogram, options.scale), 2);
  chart.lo = shown.lo;
  chart.hi = shown.hi;
  if (options.isovalue && std::isfinite(*options.isovalue)) {
    range.lo = std::min(range.lo, *options.isovalue);
    range.hi = std::max(range.hi, *options.isovalue);
  }
  const HistogramCells cells = cells_of(values, range);
  if (cells.counts.empty()) return chart;
  const auto count = static_cast<double>(cells.counts.size());
  const Along along{cells.begin, cells.begin + cells.width * count};
  chart.html = fmt::format(
      "<div class=\"chart\"><svg viewBox=\"0 0 {} {}\" preserveAspectRatio=\"none\" role=\"img\" "
      "aria-label=\"Histogram of the samples\"><path class=\"bars\" d=\"{}\"/>",
      cells.counts.size(), height, bars_path(cells.counts));
  const bool marked = options.isovalue && std::isfinite(*options.isovalue);
  if (marked)
    chart.html +=
        fmt::format("<path class=\"iso\" vector-effect=\"non-scaling-stroke\" d=\"M{:.3f} 0V{}\"/>",
                    along.percent(*options.isovalue) / 100 * count, height);
  chart.html += "</svg>" + ticks_html(along);
  if (marked) chart.html += mark_html(along, *options.isovalue);
  chart.html += "</div>\n";
  return chart;
}

}  // namespace voxweld
