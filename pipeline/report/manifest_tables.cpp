#include "pipeline/report/manifest_tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "pipeline/config/settings.h"
#include "pipeline/executor/memory_budget.h"
#include "pipeline/executor/progress.h"
#include "pipeline/report/html_text.h"

namespace voxweld {
namespace {

using nlohmann::json;

std::string bytes_text(std::uint64_t bytes) {
  return readable_bytes(static_cast<double>(bytes));
}

// A name and what there is to say of it, a row each.
class FactRows {
 public:
  // value: plain text
  void add(const std::string& name, const std::string& value) {
    if (!value.empty())
      html_ += fmt::format("<tr><th scope=\"row\">{}</th><td>{}</td></tr>\n", escaped(name),
                           escaped(value));
  }
  std::string table() const { return "<table class=\"facts\">\n" + html_ + "</table>\n"; }

 private:
  std::string html_;
};

// A bar that fills this share of its cell.
std::string bar(double share, const char* kind = "") {
  if (!(share > 0)) return "<td class=\"bar\"></td>";
  return fmt::format("<td class=\"bar\"><span class=\"{}\" style=\"width:{:.1f}%\"></span></td>",
                     kind, std::clamp(100 * share, 0.5, 100.0));
}

std::string number_cell(const std::string& text) {
  return "<td class=\"num\">" + escaped(text) + "</td>";
}

std::string surface_text(const OutputFacts& facts) {
  const Config& config = facts.config;
  const std::string side =
      config.surface.inside == SurfaceConfig::Inside::below ? "below" : "above";
  if (config.surface.label) return fmt::format("of label {}", *config.surface.label);
  if (config.labels.mode == LabelMode::each) return "labels, a closed mesh for each";
  if (config.labels.mode == LabelMode::shared) return "labels, with triangles between neighbours";
  if (!config.input.has_samples())
    return config.input.is_mesh() ? "of the mesh that is the input" : "of solids";
  if (!config.surface.isovalue) return "";
  return fmt::format("isovalue {}, material {} it", isovalue_text(*config.surface.isovalue), side);
}

void add_input(const OutputFacts& facts, FactRows& rows) {
  const VolumeGeometry& frame = facts.manifest.frame;
  if (const json* input = facts.manifest.input.get()) {
    const std::string path = input->value("path", "");
    rows.add("Input", path);
    const std::string type = input->value("type", "");
    rows.add("Read as", facts.config.input.has_samples()
                            ? fmt::format("{}, {} samples of {}", input->value("format", ""),
                                          extent_text(frame.size), type)
                            : input->value("format", ""));
  }
  if (facts.config.input.has_samples())
    rows.add("Spacing", extent_text(frame.spacing, frame.unit) +
                            (frame.unit.empty() ? " (no unit is given)" : ""));
  if (!facts.config.filters.empty())
    rows.add("Filters", grouped(facts.config.filters.size(), "filters"));
  if (!facts.config.edits.empty()) rows.add("Edits", grouped(facts.config.edits.size(), "edits"));
}

void add_files(const OutputFacts& facts, FactRows& rows) {
  const ManifestCounts& counts = facts.manifest.counts;
  std::string formats;
  for (const auto& [name, sum] : facts.formats)
    formats += fmt::format("; {} {}", name, bytes_text(sum.bytes));
  rows.add("Mesh files", fmt::format("{}, {}{}", grouped(counts.files, "files"),
                                     bytes_text(counts.bytes), formats));
  rows.add("Tiles", grouped(counts.tiles));
}

void add_mesh(const OutputFacts& facts, FactRows& rows) {
  const ManifestCounts& counts = facts.manifest.counts;
  const std::string& unit = facts.manifest.frame.unit;
  rows.add("Triangles", grouped(counts.triangles));
  rows.add("Vertices", grouped(counts.vertices));
  if (facts.manifest.labels != LabelMode::off) rows.add("Labels", grouped(counts.labels));
  if (facts.bounds)
    rows.add("Size of the mesh", extent_text(facts.bounds->hi - facts.bounds->lo, unit));
  rows.add("Border", facts.manifest.open_border ? "open at the volume's border" : "closed");
  rows.add("Coordinates", "multiples of " + with_unit(facts.manifest.lattice.step, unit));
}

void add_error(const OutputFacts& facts, FactRows& rows) {
  const json* error = facts.manifest.error.get();
  if (error == nullptr) return;
  const std::string unit = error->value("unit", "");
  const SimplifyConfig& simplify = facts.config.simplify;
  const std::string length = with_unit(error->value("tolerance", 0.0), unit);
  const std::string voxels = short_number(simplify.tolerance) + " voxels";
  const bool by_voxel = simplify.tolerance_unit == SimplifyConfig::Unit::voxel;
  rows.add("Tolerance",
           fmt::format(
               "{}{} ({}); reached where cells were merged: {}", by_voxel ? voxels : length,
               by_voxel && !unit.empty() ? ", " + length : "",
               error->value("metric", "") == "sum" ? "root of summed squares" : "root mean square",
               with_unit(error->value("reached", 0.0), unit)));
}

void add_refine(const OutputFacts& facts, FactRows& rows) {
  const json* refine = facts.manifest.refine.get();
  if (refine == nullptr) return;
  const std::string unit = refine->value("unit", "");
  const auto count = [&](const char* key) { return refine->value(key, std::uint64_t{0}); };
  rows.add("Refined",
           fmt::format("{}: {} collapsed, {} moved, {} flipped", refine->value("mode", ""),
                       grouped(count("collapses"), "edges"), grouped(count("moves"), "vertices"),
                       grouped(count("flips"), "edges")));
  rows.add("Triangles that cut each other",
           fmt::format("{} before, {} left", grouped(count("intersecting_before"), "pairs"),
                       grouped(count("intersecting_left"))));
  rows.add("Distance from the mesh before",
           fmt::format("99 % within {}, all within {}", with_unit(refine->value("p99", 0.0), unit),
                       with_unit(refine->value("worst", 0.0), unit)));
  if (!refine->contains("target")) return;
  const json& target = refine->at("target");
  rows.add("Triangles asked for",
           fmt::format("{}, of {} before; {}", grouped(target.value("triangles", std::uint64_t{0})),
                       grouped(target.value("before", std::uint64_t{0})),
                       target.value("reached", true) ? "reached" : "not reached"));
}

struct StageSums {
  double seconds = 0, slowest = 0, memory = 0;
  std::uint64_t ran = 0;
};
StageSums sums_of(const json& stages) {
  StageSums sums;
  for (const json& stage : stages) {
    const double seconds = stage.at("seconds");
    sums.seconds += seconds;
    sums.slowest = std::max(sums.slowest, seconds);
    sums.ran += stage.at("ran").get<std::uint64_t>();
    sums.memory = std::max(sums.memory, stage.at("peak_resident_bytes").get<double>());
  }
  return sums;
}

void add_time(const OutputFacts& facts, FactRows& rows) {
  if (facts.manifest.stages == nullptr || facts.manifest.stages->empty()) return;
  const StageSums sums = sums_of(*facts.manifest.stages);
  if (sums.ran == 0) return;  // it found all done
  rows.add("Time of the last run", readable_seconds(sums.seconds));
  rows.add("Peak memory", readable_bytes(sums.memory));
}

}  // namespace

std::map<std::string, FileSum> sums_by_format(const std::filesystem::path& directory,
                                              const Manifest& manifest) {
  std::map<std::string, FileSum> sums;
  const auto add = [&](const FileRecord& file) {
    ++sums[file.format].files;
    sums[file.format].bytes += file.bytes;
  };
  for (const FileRecord& file : manifest.files)
    if (file.role == "merged") add(file);
  TileListReader tiles(directory / tiles_name);
  while (const auto tile = tiles.next()) std::ranges::for_each(tile->files, add);
  return sums;
}

std::string summary_table(const OutputFacts& facts) {
  FactRows rows;
  rows.add("Surface", surface_text(facts));
  add_input(facts, rows);
  add_mesh(facts, rows);
  add_files(facts, rows);
  add_error(facts, rows);
  add_refine(facts, rows);
  add_time(facts, rows);
  return rows.table();
}

std::string stage_table(const Manifest& manifest) {
  if (manifest.stages == nullptr || manifest.stages->empty()) return {};
  const StageSums sums = sums_of(*manifest.stages);
  std::string html =
      "<table class=\"wide\">\n<thead><tr><th scope=\"col\">Stage</th>"
      "<th scope=\"col\" class=\"num\">Units</th><th scope=\"col\" class=\"num\">Ran</th>"
      "<th scope=\"col\" class=\"num\">Time</th><td></td>"
      "<th scope=\"col\" class=\"num\">Peak memory</th><td></td></tr></thead>\n<tbody>\n";
  for (const json& stage : *manifest.stages) {
    const double seconds = stage.at("seconds"), memory = stage.at("peak_resident_bytes");
    html += fmt::format(
        "<tr><th scope=\"row\">{}</th>{}{}{}{}{}{}</tr>\n",
        escaped(stage.at("stage").get<std::string>()), number_cell(grouped(stage.at("units"))),
        number_cell(grouped(stage.at("ran"))), number_cell(readable_seconds(seconds)),
        bar(sums.ran > 0 ? seconds / sums.slowest : 0), number_cell(readable_bytes(memory)),
        bar(memory / sums.memory, "second"));
  }
  return html + "</tbody>\n</table>\n";
}

std::string level_table(const Manifest& manifest) {
  const std::vector<std::uint64_t>& leaves = manifest.counts.leaves;
  if (leaves.empty() || manifest.error == nullptr) return {};
  const std::vector<double> errors = manifest.error->value("levels", std::vector<double>());
  const double tolerance = manifest.error->value("tolerance", 0.0);
  const std::string unit = manifest.error->value("unit", "");
  const auto most = static_cast<double>(*std::ranges::max_element(leaves));
  std::string html =
      "<table class=\"wide\">\n<thead><tr><th scope=\"col\">Voxels a side</th>"
      "<th scope=\"col\" class=\"num\">Cells</th><td></td>"
      "<th scope=\"col\" class=\"num\">Largest error</th><td></td></tr></thead>\n<tbody>\n";
  for (std::size_t level = 0; level < leaves.size(); ++level) {
    const bool known = level < errors.size() && leaves[level] > 0;
    html += fmt::format(
        "<tr><th scope=\"row\">{}</th>{}{}{}{}</tr>\n", std::uint64_t{1} << level,
        number_cell(grouped(leaves[level])), bar(static_cast<double>(leaves[level]) / most),
        number_cell(known ? with_unit(errors[level], unit) : ""),
        known && tolerance > 0 ? bar(errors[level] / tolerance, level == 0 ? "faint" : "second")
                               : bar(0));
  }
  return html + "</tbody>\n</table>\n";
}

std::string detail_table(const Manifest& manifest) {
  if (manifest.levels == nullptr || manifest.levels->size() < 2) return {};
  const std::string unit = manifest.frame.unit;
  const double most = manifest.levels->front().at("triangles");
  std::string html =
      "<table class=\"wide\">\n<thead><tr><th scope=\"col\">Level</th>"
      "<th scope=\"col\" class=\"num\">Tiles</th><th scope=\"col\" class=\"num\">Triangles</th>"
      "<td></td><th scope=\"col\" class=\"num\">Size</th>"
      "<th scope=\"col\" class=\"num\">Tolerance</th>"
      "<th scope=\"col\" class=\"num\">99 % within</th></tr></thead>\n<tbody>\n";
  for (const json& level : *manifest.levels) {
    const std::uint64_t triangles = level.at("triangles");
    html += fmt::format("<tr><th scope=\"row\">{}</th>{}{}{}{}{}{}</tr>\n",
                        level.at("level").get<int>(), number_cell(grouped(level.at("tiles"))),
                        number_cell(grouped(triangles)), bar(static_cast<double>(triangles) / most),
                        number_cell(readable_bytes(level.at("bytes").get<double>())),
                        number_cell(with_unit(level.value("tolerance", 0.0), unit)),
                        number_cell(with_unit(level.value("p99", 0.0), unit)));
  }
  return html + "</tbody>\n</table>\n";
}

std::vector<std::string> notes_of(const Manifest& manifest, const Config& config) {
  std::vector<std::string> notes;
  if (const json* refine = manifest.refine.get()) {
    if (const auto left = refine->value("intersecting_left", std::uint64_t{0}); left > 0)
      notes.push_back(fmt::format("{} of triangles still cut each other.", grouped(left, "pairs")));
    if (refine->contains("target") && !refine->at("target").value("reached", true))
      notes.emplace_back("The number of triangles that was asked for could not be reached.");
  }
  if (!manifest.merged && config.output.merged != OutputConfig::Merged::never &&
      manifest.labels != LabelMode::each)
    notes.emplace_back(
        "There is no merged mesh, for it does not fit run.memory; the tiles are complete.");
  if (manifest.free_topology)
    notes.emplace_back(
        "simplify.topology = \"free\": the mesh is closed, but need not be a manifold.");
  if (manifest.open_border)
    notes.emplace_back("The mesh is open where it meets the volume's border.");
  if (manifest.counts.collinear > 0)
    notes.push_back(
        fmt::format("{} without an area.", grouped(manifest.counts.collinear, "triangles")));
  return notes;
}

}  // namespace voxweld
