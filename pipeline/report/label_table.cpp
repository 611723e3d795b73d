// The largest labels of an output directory.
#include <fmt/format.h>

#include <algorithm>

#include "pipeline/report/html_text.h"
#include "pipeline/report/manifest_tables.h"
#include "pipeline/report/slice_figures.h"

namespace voxweld {
namespace {

constexpr std::size_t most_told = 12;

// By volume; where the border is open and there is none, by triangles.
bool is_larger(const LabelRecord& a, const LabelRecord& b) {
  if (a.volume && b.volume && *a.volume != *b.volume) return *a.volume > *b.volume;
  if (a.triangles != b.triangles) return a.triangles > b.triangles;
  return a.label < b.label;
}

std::string colour_of(const LabelRecord& record) {
  MaterialTable table;
  if (const auto& c = record.color)
    table.entries.push_back({record.label, {}, MaterialColor{(*c)[0], (*c)[1], (*c)[2]}});
  return css_colour(table, record.label);
}

std::string row_of(const LabelRecord& record, const std::string& unit) {
  const std::string square = unit.empty() ? "" : unit + "²", cube = unit.empty() ? "" : unit + "³";
  const std::string extent =
      record.bounds ? extent_text(record.bounds->hi - record.bounds->lo, unit) : "";
  return fmt::format(
      "<tr><th scope=\"row\"><span class=\"swatch\" style=\"background:{}\"></span>{}{}</th>"
      "<td class=\"num\">{}</td><td class=\"num\">{}</td><td class=\"num\">{}</td>"
      "<td class=\"num\">{}</td></tr>\n",
      colour_of(record), record.label, record.name.empty() ? "" : " " + escaped(record.name),
      record.volume ? escaped(with_unit(*record.volume, cube)) : "",
      escaped(with_unit(record.area, square)), grouped(record.triangles), escaped(extent));
}

}  // namespace

std::string label_table(const std::filesystem::path& directory, const Manifest& manifest) {
  if (manifest.labels == LabelMode::off) return {};
  std::vector<LabelRecord> largest;
  LabelListReader list(directory / labels_name);
  while (const auto record = list.next()) {
    const auto at = std::upper_bound(largest.begin(), largest.end(), *record, is_larger);
    if (at == largest.end() && largest.size() == most_told) continue;
    largest.insert(at, *record);
    if (largest.size() > most_told) largest.pop_back();
  }
  if (largest.empty()) return {};
  std::string html =
      "<table class=\"wide\">\n<thead><tr><th scope=\"col\">Label</th>"
      "<th scope=\"col\" class=\"num\">Volume</th><th scope=\"col\" class=\"num\">Area</th>"
      "<th scope=\"col\" class=\"num\">Triangles</th><th scope=\"col\" class=\"num\">Size</th>"
      "</tr></thead>\n<tbody>\n";
  for (const LabelRecord& record : largest) html += row_of(record, manifest.frame.unit);
  return html + "</tbody>\n</table>\n";
}

}  // namespace voxweld
