#include "pipeline/config/commented.h"

#include <fmt/format.h>

#include <functional>
#include <map>
#include <set>
#include <string_view>

#include "pipeline/config/edit_settings.h"
#include "pipeline/config/filter_settings.h"
#include "pipeline/config/settings.h"
#include "pipeline/config/text_layout.h"

namespace voxweld {
namespace {

std::string real(double value) {
  return to_toml(ConfigValue{value});
}

// Comments hold one line and no control characters.
std::string comment_text(std::string text) {
  for (char& c : text)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = ' ';
  return text;
}

// A value for a key that is commented out and has no default of its own.
std::string sample_value(const Setting& setting) {
  static const std::map<std::string, std::string> samples = {
      {"input.crop", "[0, 0, 0, 256, 256, 256]"},
      {"input.spacing", "[1.0, 1.0, 1.0]"},
      {"input.unit", "\"mm\""},
      {"input.dataset", "\"/entry/data/data\""},
      {"input.series", "\"1\""},
      {"input.level", "0"},
      {"input.channel", "0"},
      {"input.time", "0"},
      {"input.size", "[512, 512, 512]"},
      {"input.type", "\"uint16\""},
      {"input.resolution", "512"},
      {"input.cell", "0.1"},
      {"surface.isovalue", "\"otsu\""},
      {"surface.label", "7"},
      {"labels.map", "\"labels.csv\""},
      {"simplify.triangles", "100000"},
      {"simplify.ratio", "0.1"},
      {"work.directory", "\"scan.work\""},
      {"output.directory", "\"scan.mesh\""}};
  const auto found = samples.find(setting.name());
  return found == samples.end() ? setting.default_text() : found->second;
}

// The default is told where no value beside the text shows it.
std::string described(const KeyFacts& key, const std::string& begin, bool tell_default) {
  std::string text = begin + key.description + " Takes " + accepted_text(key.rule) + ".";
  if (tell_default && !key.required) text += " Default: " + key.default_text() + ".";
  return wrapped(text, "# ");
}

// The values of the keys that are active; the others are written as comments.
using Active = std::map<std::string, std::string>;

using Names = std::set<std::string>;  // "table.key"

// Keys that an input of one kind has no use for, and refuses.
const Names& of_volumes() {
  static const Names names = {"input.crop",         "input.spacing",    "input.size",
                              "input.dataset",      "input.series",     "input.level",
                              "input.channel",      "input.time",       "input.resample",
                              "input.follow",       "input.type",       "input.endian",
                              "input.header_bytes", "surface.isovalue", "surface.label",
                              "surface.inside",     "surface.gradient"};
  return names;
}
const Names& of_meshes() {
  static const Names names = {"input.resolution", "input.cell", "input.margin", "input.close"};
  return names;
}

// The comments of a brief config: one line for each key that it may have.
const std::string& brief_comment(const std::string& name) {
  static const std::map<std::string, std::string> comments = {
      {"input.path", "The volume or mesh to read. A relative path begins at this file's folder."},
      {"input.format", "How to read it: here samples without a header."},
      {"input.size", "Samples along x, y and z; x is the fastest in the file."},
      {"input.type", "Type of a sample."},
      {"input.endian", "Byte order of a sample: \"little\" or \"big\"."},
      {"input.header_bytes", "Bytes before the first sample."},
      {"input.dataset", "Which array or grid of the file."},
      {"input.series", "Which series of the folder."},
      {"input.level", "Which resolution; 0 is the finest."},
      {"input.channel", "Which channel, counted from 0."},
      {"input.time", "Which point in time, counted from 0."},
      {"input.resample", "\"uniform\" interpolates slices at equal distances."},
      {"input.follow", "Whether the header may name data files outside its folder."},
      {"input.spacing", "Distance of neighbouring samples along x, y and z."},
      {"input.unit", "Unit of the spacing."},
      {"input.resolution", "Cells along the mesh's longest side: more are finer, and more work."},
      {"input.cell", "The side of a cell, in the mesh's unit: smaller is finer, and more work."},
      {"input.close", "\"winding\" closes the mesh's holes, \"no\" refuses a mesh that has any."},
      {"surface.isovalue", "The value the surface runs through."},
      {"surface.inside", "Which side of the isovalue is material: \"above\" or \"below\"."},
      {"labels.mode",
       "\"each\": a closed mesh for each label; \"shared\": neighbours share triangles."},
      {"labels.background", "Labels that get no mesh."},
      {"simplify.tolerance",
       "How far the mesh may be from the surface, in voxels: more is smaller."},
      {"output.formats", "File formats to write."},
      {"run.memory", "The most memory to use."}};
  return comments.at(name);
}

// Only what is active.
std::string brief_table(const std::string& table, const Active& active) {
  std::string text;
  for (const Setting& setting : settings()) {
    const auto value = active.find(setting.name());
    if (setting.table != table || value == active.end()) continue;
    text +=
        fmt::format("# {}\n{} = {}\n", brief_comment(setting.name()), setting.key, value->second);
  }
  return text.empty() ? text : fmt::format("\n[{}]\n{}", table, text);
}

std::string table_text(const std::string& table, const Active& active, const Names& left_out = {}) {
  std::string text = fmt::format("\n[{}]\n", table);
  for (const Setting& setting : settings()) {
    if (setting.table != table || left_out.contains(setting.name())) continue;
    const auto value = active.find(setting.name());
    text += described(setting, "", !setting.default_note.empty());
    text += value == active.end() ? fmt::format("# {} = {}\n\n", setting.key, sample_value(setting))
                                  : fmt::format("{} = {}\n\n", setting.key, value->second);
  }
  text.pop_back();
  return text;
}

// What the items of a list take, then one of each kind, all commented out.
template <class Item, class Kind>
std::string item_samples(const ItemTable<Item, Kind>& table) {
  std::string text = fmt::format("\n{}", wrapped(table.description, "# "));
  for (const auto& setting : table.settings) {
    const std::string kinds =
        setting.kinds.empty() ? "" : fmt::format(" ({})", table.kinds_text(setting));
    text += fmt::format("#\n{}", described(setting, setting.key + kinds + ": ", true));
  }
  for (const Kind kind : table.kinds()) {
    text += fmt::format("\n# [[{}]]\n", table.name);
    for (const auto& setting : table.settings)
      if (setting.taken_by(kind))
        text += fmt::format(
            "# {} = {}\n", setting.key,
            setting.key == table.kind_key ? toml_string(table.kind_name(kind)) : setting.sample);
  }
  return text;
}

std::string facts(const VolumeInfo& info, const InitSuggestion& suggestion) {
  const VolumeGeometry& g = info.geometry;
  std::string text = fmt::format("# {} x {} x {} samples of {}, {} to {}, read as {}\n", g.size.x,
                                 g.size.y, g.size.z, sample_type_name(info.type),
                                 real(suggestion.lowest), real(suggestion.highest), info.format);
  const Vec3 spacing = suggestion.spacing.value_or(g.spacing);
  const std::string unit = g.unit.empty() ? "(the file names no unit)" : comment_text(g.unit);
  text += fmt::format("# spacing {} x {} x {} {}\n", real(spacing.x), real(spacing.y),
                      real(spacing.z), unit);
  if (!info.scale.identity())
    text += fmt::format("# real values are {} * stored + {}; all values here are real\n",
                        real(info.scale.slope), real(info.scale.intercept));
  for (const std::string& warning : info.warnings)
    text += wrapped("Note: " + comment_text(warning), "# ");
  return text;
}

std::string default_of(const char* table, const char* key) {
  return to_toml(*find_setting(table, key)->get(Config{}));
}

// Those one is likely to touch, whatever the input is, at their defaults.
Active usual_keys() {
  Active active;
  active["simplify.tolerance"] = default_of("simplify", "tolerance");
  active["output.formats"] = default_of("output", "formats");
  active["run.memory"] = default_of("run", "memory");
  return active;
}

Active active_for(const VolumeInfo& info, const InitSuggestion& suggestion) {
  Active active = usual_keys();
  active["input.path"] = toml_string(suggestion.path);
  if (info.format == "raw") {
    const Index3 size = info.geometry.size;
    active["input.format"] = "\"raw\"";
    active["input.size"] = fmt::format("[{}, {}, {}]", size.x, size.y, size.z);
    active["input.type"] = toml_string(sample_type_name(info.type));
    active["input.endian"] =
        suggestion.endian == InputConfig::Endian::big ? "\"big\"" : "\"little\"";
    active["input.header_bytes"] = std::to_string(suggestion.header_bytes);
  }
  if (suggestion.spacing)
    active["input.spacing"] = fmt::format("[{}, {}, {}]", real(suggestion.spacing->x),
                                          real(suggestion.spacing->y), real(suggestion.spacing->z));
  const InputSelection& select = suggestion.select;
  if (!select.dataset.empty()) active["input.dataset"] = toml_string(select.dataset);
  if (!select.series.empty()) active["input.series"] = toml_string(select.series);
  if (select.level) active["input.level"] = std::to_string(*select.level);
  if (select.channel) active["input.channel"] = std::to_string(*select.channel);
  if (select.time) active["input.time"] = std::to_string(*select.time);
  if (suggestion.resample == Resample::uniform) active["input.resample"] = "\"uniform\"";
  if (suggestion.follow) active["input.follow"] = "true";
  if (!suggestion.unit.empty()) active["input.unit"] = toml_string(suggestion.unit);
  if (suggestion.labels) {
    active["labels.mode"] = "\"each\"";
    active["labels.background"] = default_of("labels", "background");
  } else {
    active["surface.isovalue"] = real(suggestion.isovalue);
    active["surface.inside"] =
        suggestion.inside == SurfaceConfig::Inside::above ? "\"above\"" : "\"below\"";
  }
  return active;
}

std::string first_lines(ConfigExtent extent) {
  if (extent == ConfigExtent::full)
    return "# voxweld config. Keys that begin with # are at their defaults.\n";
  return "# voxweld config with the keys one is likely to change; `voxweld settings` lists all.\n";
}

std::string tables_text(const Active& active, ConfigExtent extent, const Names& left_out) {
  std::string text;
  for (const std::string& table : table_names())
    text += extent == ConfigExtent::full ? table_text(table, active, left_out)
                                         : brief_table(table, active);
  return text;
}

}  // namespace

std::string commented_config(const VolumeInfo& info, const InitSuggestion& suggestion,
                             ConfigExtent extent) {
  std::string text = first_lines(extent) + facts(info, suggestion);
  text += tables_text(active_for(info, suggestion), extent, of_meshes());
  // Where the number came from belongs beside it.
  const auto isovalue = text.find("\nisovalue = ");
  if (isovalue != std::string::npos)
    text.insert(isovalue + 1, fmt::format("# {}; the samples lie in {} to {}.\n",
                                          info.surface ? "The surface that the file says it has"
                                                       : "Suggested by the histogram (\"otsu\")",
                                          real(suggestion.lowest), real(suggestion.highest)));
  return text;
}

std::string commented_config(const MeshSuggestion& mesh, ConfigExtent extent) {
  const VolumeGeometry& g = mesh.geometry;
  std::string text = first_lines(extent);
  text += fmt::format("# {} triangles and {} vertices, closed{}, read as {}\n", mesh.triangles,
                      mesh.vertices, mesh.close == MeshClosing::no ? "" : " by winding number",
                      mesh.format);
  text += fmt::format("# from {}, {}, {} to {}, {}, {}\n", real(mesh.lo.x), real(mesh.lo.y),
                      real(mesh.lo.z), real(mesh.hi.x), real(mesh.hi.y), real(mesh.hi.z));
  text += fmt::format("# sampled at {} x {} x {} places, {} apart\n", g.size.x, g.size.y, g.size.z,
                      real(g.spacing.x));
  Active active = usual_keys();
  active["input.path"] = toml_string(mesh.path);
  if (!mesh.unit.empty()) active["input.unit"] = toml_string(mesh.unit);
  if (mesh.resolution) active["input.resolution"] = std::to_string(*mesh.resolution);
  if (mesh.cell) active["input.cell"] = real(*mesh.cell);
  if (mesh.close == MeshClosing::winding) active["input.close"] = "\"winding\"";
  return text + tables_text(active, extent, of_volumes());
}

std::string reference_config() {
  const Config defaults;
  Active active;
  for (const Setting& setting : settings())
    if (setting.default_note.empty()) active[setting.name()] = to_toml(*setting.get(defaults));
  active["input.path"] = "\"scan.nrrd\"";
  active["surface.isovalue"] = "\"otsu\"";
  // Only raw files and meshes take these.
  for (const char* name : {"input.endian", "input.header_bytes", "input.margin", "input.close"})
    active.erase(name);
  std::string text = "#:schema voxweld.schema.json\n";
  text += "# Every key there is. Those that begin with # have no value unless one is given.\n";
  for (const std::string& table : table_names()) text += table_text(table, active);
  return text + item_samples(filter_items()) + item_samples(edit_items());
}

}  // namespace voxweld
