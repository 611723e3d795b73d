#include <algorithm>

#include "storage/store/pyramid.h"
#include "storage/store/zarr_fields.h"
#include "storage/store/zarr_json.h"

namespace voxweld {
namespace {

using Json = nlohmann::ordered_json;

// The group's attributes about images, and the file that says so.
struct ImageAttributes {
  Json document;
  std::string file;
};

std::optional<ImageAttributes> image_attributes_of(const StoreFolder& group) {
  for (const char* name : {".zattrs", "zarr.json"}) {
    const auto text = group.text(name);
    if (!text) continue;
    const std::string file = (group / name).name();
    const Json document = parse_zarr_document(*text, file);
    const Json* at = &document;
    for (const char* key : {"attributes", "ome"})
      if (at->is_object() && at->contains(key)) at = &at->at(key);
    if (at->is_object() && at->contains("multiscales")) return ImageAttributes{*at, file};
  }
  return std::nullopt;
}

std::vector<double> numbers_of(const JsonField& list) {
  std::vector<double> numbers;
  for (const JsonField& number : list.elements()) numbers.push_back(number.real());
  return numbers;
}

// Scales are multiplied, translations scaled and added, in the order in which they are listed.
void apply(const JsonField& holder, Pyramid::Level& level) {
  if (!holder.has("coordinateTransformations")) return;
  for (const JsonField& step : holder.at("coordinateTransformations").elements()) {
    const std::string type = step.at("type").text();
    if (type == "identity") continue;
    if (type != "scale" && type != "translation")
      step.refuse("\"scale\" or \"translation\" expected, " + step.at("type").shown() + " found");
    const std::vector<double> by = numbers_of(step.at(type.c_str()));
    if (level.scale.empty()) level.scale.assign(by.size(), 1);
    if (level.translation.empty()) level.translation.assign(by.size(), 0);
    if (by.size() != level.scale.size())
      step.refuse(fmt::format("{} numbers expected, {} found", level.scale.size(), by.size()));
    for (std::size_t d = 0; d < by.size(); ++d) {
      if (type == "translation") {
        level.translation[d] += by[d];
        continue;
      }
      level.scale[d] *= by[d];
      level.translation[d] *= by[d];
    }
  }
}

// The names, and the units of all levels. Versions 0.1 and 0.2 name none: they are always five.
std::vector<std::string> read_axes(const JsonField& multiscale, Pyramid& pyramid) {
  std::vector<std::string> units;
  if (!multiscale.has("axes")) {
    pyramid.axes = {"t", "c", "z", "y", "x"};
    return units;
  }
  for (const JsonField& axis : multiscale.at("axes").elements()) {
    const bool named = axis.value().is_object();  // 0.3 has names alone
    const auto text = [&](const char* key) {
      return named && axis.has(key) ? axis.at(key).text() : std::string();
    };
    pyramid.axes.push_back(named ? axis.at("name").text() : axis.text());
    pyramid.types.push_back(text("type"));
    units.push_back(text("unit"));
  }
  return units;
}

void read_channels(const JsonField& attributes, Pyramid& pyramid) {
  if (!attributes.has("omero") || !attributes.at("omero").has("channels")) return;
  const JsonField channels = attributes.at("omero").at("channels");
  if (!channels.value().is_array()) return;
  for (const JsonField& channel : channels.elements()) {
    const bool said = channel.has("label") && channel.at("label").value().is_string();
    pyramid.channels.push_back(said ? channel.at("label").text() : "");
  }
}

std::string level_path(const JsonField& dataset) {
  const auto path = key_of(dataset.at("path").text());
  if (!path) dataset.refuse("a path inside the group expected, " + dataset.shown());
  return *path;
}

}  // namespace

ArrayContext Pyramid::context(std::size_t level) const {
  ArrayContext context;
  context.axes = axes;
  context.types = types;
  context.units = levels[level].units;
  context.scale = levels[level].scale;
  context.translation = levels[level].translation;
  context.channels = channels;
  context.where = where;
  return context;
}

std::vector<Pyramid> ome_pyramids_of(const StoreFolder& group) {
  std::vector<Pyramid> pyramids;
  const auto attributes = image_attributes_of(group);
  if (!attributes) return pyramids;
  const JsonField root(attributes->document, attributes->file, "");
  for (const JsonField& multiscale : root.at("multiscales").elements()) {
    Pyramid pyramid;
    pyramid.where = attributes->file;
    if (multiscale.has("name") && multiscale.at("name").value().is_string())
      pyramid.name = multiscale.at("name").text();
    const std::vector<std::string> units = read_axes(multiscale, pyramid);
    read_channels(root, pyramid);
    for (const JsonField& dataset : multiscale.at("datasets").elements()) {
      Pyramid::Level level;
      level.path = level_path(dataset);
      level.units = units;
      apply(dataset, level);
      apply(multiscale, level);
      pyramid.levels.push_back(std::move(level));
    }
    if (!pyramid.levels.empty()) pyramids.push_back(std::move(pyramid));
  }
  return pyramids;
}

std::optional<ArrayContext> ome_context_of(const StoreFolder& array) {
  constexpr int most_levels = 4;
  std::string within;
  auto above = array.above();
  for (int i = 0; i < most_levels && above; ++i) {
    within = within.empty() ? above->name : above->name + '/' + within;
    for (const Pyramid& pyramid : ome_pyramids_of(above->folder))
      for (std::size_t level = 0; level < pyramid.levels.size(); ++level)
        if (pyramid.levels[level].path == within) return pyramid.context(level);
    above = above->folder.above();
  }
  return std::nullopt;
}

}  // namespace voxweld
