#include "pipeline/report/report.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "pipeline/output/load.h"
#include "pipeline/report/histogram_chart.h"
#include "pipeline/report/html_text.h"
#include "pipeline/report/manifest_tables.h"
#include "pipeline/report/mesh_views.h"
#include "pipeline/report/page.h"
#include "pipeline/report/png.h"
#include "pipeline/report/report_volume.h"
#include "pipeline/report/settings_section.h"
#include "pipeline/report/slice_figures.h"
#include "pipeline/report/timeline.h"
#include "storage/manifest/report_file.h"
#include "storage/support/error.h"
#include "storage/support/file_io.h"
#include "storage/support/hash.h"
#include "storage/support/json_text.h"

namespace voxweld {
namespace {

namespace fs = std::filesystem;

// Raised when a page of the same run comes to look different.
constexpr std::uint64_t report_version = 2;

// An output directory and the config it was made by.
struct Run {
  Manifest manifest;
  Config config;
};

Run read_run(const fs::path& directory) {
  require_output(directory);
  Run run;
  run.manifest = read_manifest(directory / manifest_name);
  const std::string where = (directory / manifest_name).string();
  if (run.manifest.config == nullptr || !run.manifest.config->is_object() ||
      !run.manifest.config->contains("toml"))
    throw FormatError(where +
                      ": has no config, as a run writes it; make the meshes again with "
                      "`voxweld run`");
  run.config = parse_config(run.manifest.config->at("toml").get<std::string>(),
                            run.manifest.config->value("path", "config.toml"));
  return run;
}

// Of all that the page depends on and that can change. Not of the times: where a run finds all done
// those of the run that did it are what is worth a look, and they are in the page that is there.
std::string report_key(const fs::path& directory, const Run& run) {
  nlohmann::json manifest = nlohmann::json::parse(read_text_file(directory / manifest_name));
  manifest.erase("stages");
  manifest.erase("made_by");
  KeyHasher key;
  key.integer(report_version).text(directory.filename().string()).text(json_text(manifest));
  key.text(why_no_volume(run.manifest, run.config));
  return to_hex(key.finish());
}

PageSection view_section(const ReportOptions& options, const Run& run,
                         std::optional<MeshBounds>& bounds) {
  ViewOptions view;
  view.threads = options.threads;
  view.memory = options.memory;
  view.triangles = run.manifest.counts.triangles;
  // A triangle between labels is the front of one of them and the back of the other.
  view.closed = !run.manifest.open_border && run.manifest.labels != LabelMode::shared;
  view.interrupt = options.interrupt;
  const MeshViews views = draw_views(options.directory, view);
  bounds = views.bounds;
  std::string html = "<div class=\"three\">\n";
  for (std::size_t i = 0; i < views.pictures.size(); ++i) {
    const Image& image = views.pictures[i];
    html += fmt::format(
        "<figure><img src=\"{}\" width=\"{}\" height=\"{}\" alt=\"The mesh from azimuth {:.0f}\">"
        "<figcaption>azimuth {:.0f}°, elevation {:.0f}°</figcaption></figure>\n",
        png_address({image.width, image.height, 3, image.rgb}), image.width, image.height,
        view_azimuths[i], view_azimuths[i], view_elevation);
  }
  return {"The mesh", "", html + "</div>\n"};
}

std::string histogram_intro(const VolumeLook& look) {
  const auto all = static_cast<std::uint64_t>(Box3{{}, look.info.geometry.size}.count());
  const std::uint64_t counted = look.samples.counted;
  const std::string of = counted < all ? fmt::format("Of {} of {} samples, spread over the volume.",
                                                     grouped(counted), grouped(all))
                                       : fmt::format("Of all {} samples.", grouped(all));
  return of + " The scale is logarithmic" +
         (look.samples.histogram.nans > 0
              ? fmt::format("; {} of these samples are no numbers (NaN).",
                            grouped(look.samples.histogram.nans))
              : ".");
}

std::string slice_intro(const Config& config) {
  if (is_of_labels(config))
    return "Slices through the middle of the volume, in the colours of the labels.";
  std::string intro =
      "Slices through the middle of the volume. The line is where the samples have the isovalue.";
  if (!config.edits.empty()) intro += " Edits are not in it.";
  return intro;
}

void add_volume_sections(const Run& run, const VolumeLook& look, const fs::path& directory,
                         Page& page) {
  const bool labels = is_of_labels(run.config);
  SliceStyle style;
  style.spacing = run.manifest.frame.spacing;
  style.first = run.manifest.frame.first;
  style.unit = run.manifest.frame.unit;
  HistogramChart chart;
  if (labels) {
    style.colours = listed_colours(directory);
    style.label = run.config.surface.label;
  } else {
    if (run.config.surface.isovalue) style.isovalue = run.config.surface.isovalue->value;
    style.below = run.config.surface.inside == SurfaceConfig::Inside::below;
    chart = histogram_chart(look.samples.histogram, {look.info.scale, style.isovalue});
    style.dark = chart.lo;
    style.light = chart.hi;
  }
  std::string slices = "<div class=\"three\">\n";
  for (const Slice& slice : look.samples.slices) slices += slice_figure(slice, style);
  page.sections.push_back({"Slices", slice_intro(run.config), slices + "</div>\n"});
  page.sections.push_back({"Histogram", histogram_intro(look), chart.html});
}

// Slices and histogram, or a sentence why there are none.
void add_volume(const ReportOptions& options, const Run& run, Page& page,
                std::vector<std::string>& notes) {
  std::string why = why_no_volume(run.manifest, run.config);
  if (why.empty()) {
    try {
      SampleRequest request;
      request.interrupt = options.interrupt;
      const VolumeLook look = look_at_volume(run.manifest, run.config, request);
      add_volume_sections(run, look, options.directory, page);
      notes.insert(notes.end(), look.warnings.begin(), look.warnings.end());
      return;
    } catch (const Interrupted&) {
      throw;
    } catch (const Error& error) {
      why = fmt::format("The volume cannot be read: {}.", error.what());
    }
  }
  page.sections.push_back(
      {"Volume", "", "<p>" + escaped(why) + " So there are no slices and no histogram.</p>\n"});
}

std::string list_of(const std::vector<std::string>& notes) {
  if (notes.empty()) return {};
  std::string html = "<ul>\n";
  for (const std::string& note : notes) html += "<li>" + escaped(note) + "</li>\n";
  return html + "</ul>\n";
}

std::string scrolled(const std::string& table) {
  return table.empty() ? table : "<div class=\"scroll\">\n" + table + "</div>\n";
}

// The manifest's own words are plain text, times are UTC.
std::string footer_of(const Manifest& manifest) {
  if (manifest.made_by == nullptr) return "";
  const auto text = [&](const char* key) { return manifest.made_by->value(key, ""); };
  std::string footer = "Made by " + text("program");
  if (!text("time").empty()) footer += " at " + text("time");
  if (!text("host").empty()) footer += " on " + text("host");
  return footer + ".";
}

// Of the run's own tasks, where it had a cluster.
PageSection cluster_section(const Run& run) {
  const Timeline times = timeline(task_times(run.config));
  return {"On the cluster", times.intro, times.html};
}

std::string lede_of(const Manifest& manifest) {
  std::string lede = grouped(manifest.counts.triangles, "triangles") + ", " +
                     grouped(manifest.counts.vertices, "vertices");
  if (manifest.labels != LabelMode::off) lede += ", " + grouped(manifest.counts.labels, "labels");
  return lede + ", made by voxweld.";
}

Page make_page(const ReportOptions& options, const Run& run) {
  const fs::path name = options.directory.filename();
  Page page;
  page.title = name.string();
  page.lede = lede_of(run.manifest);
  page.key = report_key(options.directory, run);
  page.footer = footer_of(run.manifest);
  OutputFacts facts{run.manifest, run.config, {}, sums_by_format(options.directory, run.manifest)};
  page.sections.push_back(view_section(options, run, facts.bounds));
  page.sections.push_back({"What was made", "", summary_table(facts)});
  std::vector<std::string> notes = notes_of(run.manifest, run.config);
  add_volume(options, run, page, notes);
  page.sections.push_back({"Levels of detail",
                           "Each as the whole mesh. Distances are from the mesh of the finest "
                           "cells for level 0, and from "
                           "the levels before, at some of their points, for the others.",
                           scrolled(detail_table(run.manifest))});
  page.sections.push_back({"Stages", "What the last run did. Of what was done already nothing ran.",
                           scrolled(stage_table(run.manifest))});
  page.sections.push_back(cluster_section(run));
  page.sections.push_back(
      {"Cells and errors",
       "Cells of the octree by their size, and the largest distance of a vertex from the planes it "
       "stands for. Bars of the error end at the tolerance; the smallest cells are not merged.",
       scrolled(level_table(run.manifest))});
  page.sections.push_back(
      {"Largest labels", "", scrolled(label_table(options.directory, run.manifest))});
  page.sections.push_back({"Notes", "", list_of(notes)});
  page.sections.push_back({"Config", "Settings that differ from their defaults.",
                           settings_section(run.manifest, run.config)});
  return page;
}

// The directory with a name, whatever stands behind it.
ReportOptions resolved(ReportOptions options) {
  options.directory = fs::absolute(options.directory).lexically_normal();
  if (!options.directory.has_filename()) options.directory = options.directory.parent_path();
  return options;
}

template <class F>
auto of_manifest(const fs::path& directory, F&& f) {
  try {
    return f();
  } catch (const nlohmann::json::exception& error) {
    throw FormatError(fmt::format("{}: not as a run writes it: {}",
                                  (directory / manifest_name).string(), error.what()));
  }
}

}  // namespace

std::string report_text(const ReportOptions& asked) {
  const ReportOptions options = resolved(asked);
  return of_manifest(options.directory,
                     [&] { return page_html(make_page(options, read_run(options.directory))); });
}

void write_report(const ReportOptions& options) {
  write_whole_file(options.file, as_bytes(report_text(options)), Durability::rename_only);
}

bool report_is_current(const ReportOptions& asked) {
  const ReportOptions options = resolved(asked);
  const std::string key = key_of_page(beginning_of_page(options.file));
  return !key.empty() && of_manifest(options.directory, [&] {
    return key == report_key(options.directory, read_run(options.directory));
  });
}

}  // namespace voxweld
