// Spacing and origin of arrays of N5, for which there is no standard but customs of several viewers.
#include <fmt/format.h>

#include <algorithm>

#include "storage/store/n5.h"
#include "storage/store/pyramid.h"
#include "storage/store/zarr_fields.h"
#include "storage/store/zarr_json.h"
#include "storage/support/text_fields.h"

namespace voxweld {
namespace {

using Json = nlohmann::ordered_json;

struct Attributes {
  Json document;
  std::string file;
  JsonField root() const { return {document, file, ""}; }
};

std::optional<Attributes> attributes_of(const StoreFolder& folder) {
  const auto text = folder.text("attributes.json");
  if (!text) return std::nullopt;
  const std::string file = (folder / "attributes.json").name();
  Attributes attributes{parse_zarr_document(*text, file), file};
  if (!attributes.document.is_object())
    attributes.root().refuse("an object expected, " + attributes.root().shown() + " found");
  return attributes;
}

// A list of numbers under the name, in x, y, z; with `unit` where it is an object.
std::optional<std::vector<double>> numbers(const JsonField& holder, const char* name,
                                           std::string* unit = nullptr) {
  if (!holder.has(name)) return std::nullopt;
  const JsonField field = holder.at(name);
  if (field.value().is_object() && field.has("dimensions")) {
    if (unit != nullptr && field.has("unit") && field.at("unit").value().is_string())
      *unit = field.at("unit").text();
    return numbers(field, "dimensions");
  }
  if (!field.value().is_array()) return std::nullopt;
  std::vector<double> all;
  for (const JsonField& element : field.elements()) {
    if (!element.value().is_number()) return std::nullopt;
    all.push_back(element.real());
  }
  return all;
}

std::string unit_of(const JsonField& holder) {
  for (const char* name : {"units", "unit"}) {
    if (!holder.has(name)) continue;
    const JsonField field = holder.at(name);
    if (field.value().is_string()) return field.text();
    if (field.value().is_array() && !field.value().empty() && field.value()[0].is_string())
      return field.value()[0].get<std::string>();
  }
  return {};
}

// The factors of one level of those that a group lists for all.
std::optional<std::vector<double>> listed_factors(const JsonField& group, std::size_t level) {
  for (const char* name : {"scales", "downsamplingFactors"}) {
    if (!group.has(name) || !group.at(name).value().is_array()) continue;
    const auto all = group.at(name).elements();
    if (level >= all.size() || !all[level].value().is_array()) continue;
    std::vector<double> factors;
    for (const JsonField& factor : all[level].elements()) factors.push_back(factor.real());
    return factors;
  }
  return std::nullopt;
}

// {"axes": ["z", "y", "x"], "scale": [...], "translate": [...], "units": [...]}
bool take_transform(const JsonField& holder, ArrayContext& context) {
  if (!holder.has("transform") || !holder.at("transform").has("scale")) return false;
  const JsonField transform = holder.at("transform");
  const auto scale = numbers(transform, "scale");
  const auto translation = numbers(transform, "translate");
  if (!scale || (translation && translation->size() != scale->size())) return false;
  context.scale = *scale;
  context.translation = translation.value_or(std::vector<double>(scale->size(), 0));
  if (transform.has("axes"))
    for (const JsonField& axis : transform.at("axes").elements())
      context.axes.push_back(axis.text());
  if (transform.has("units"))
    for (const JsonField& unit : transform.at("units").elements())
      context.units.push_back(unit.text());
  if (context.axes.empty()) return true;
  // Its axes are in any order, the array's are z, y, x.
  const ArrayContext said = context;
  for (std::size_t d = 0; d < said.axes.size() && said.axes.size() == scale->size(); ++d) {
    std::vector<std::string> order{"x", "y", "z"};
    const auto axis = std::ranges::find(order, lower(said.axes[d])) - order.begin();
    const auto to =
        static_cast<std::size_t>(static_cast<std::ptrdiff_t>(said.axes.size()) - 1 - axis);
    if (axis > 2 || to >= said.axes.size()) continue;
    context.axes[to] = said.axes[d];
    context.scale[to] = said.scale[d];
    context.translation[to] = said.translation[d];
    if (said.units.size() == said.axes.size()) context.units[to] = said.units[d];
  }
  return true;
}

// Of the level of a pyramid: from the array's attributes, or from those of the groups above.
void take_resolution(const Attributes& own, std::size_t level, const std::vector<Attributes>& above,
                     ArrayContext& context) {
  std::string unit = unit_of(own.root());
  std::optional<std::vector<double>> step, factors = numbers(own.root(), "downsamplingFactors"),
                                           offset = numbers(own.root(), "offset");
  const auto look = [&](const JsonField& holder) {
    for (const char* name : {"pixelResolution", "resolution"})
      if (!step) step = numbers(holder, name, &unit);
  };
  look(own.root());
  const bool own_step = step.has_value();
  for (const Attributes& group : above) {
    look(group.root());
    if (!factors) factors = listed_factors(group.root(), level);
    if (!offset) offset = numbers(group.root(), "offset");
    if (unit.empty()) unit = unit_of(group.root());
  }
  if (!step || (!factors && !own_step && level > 0)) return;
  if (!factors) factors = std::vector<double>(step->size(), 1);
  if (factors->size() != step->size()) return;
  context.scale.clear();
  for (std::size_t a = step->size(); a-- > 0;) {
    const double at = offset && offset->size() == step->size() ? (*offset)[a] : 0;
    context.scale.push_back((*step)[a] * (*factors)[a]);
    // Samples lie in the middle of those that they stand for.
    context.translation.push_back(at + ((*factors)[a] - 1) / 2 * (*step)[a]);
    context.units.push_back(unit);
  }
}

// Of "s2" it is 2.
std::size_t level_of(const std::string& name) {
  const auto number = name.starts_with('s') ? parse_integer(name.substr(1)) : std::nullopt;
  return number && *number >= 0 && *number < 64 ? static_cast<std::size_t>(*number) : 0;
}

// "multiscales" of the group, as OME-Zarr has them but each dataset with a "transform".
bool take_listed_transform(const Attributes& group, const std::string& name,
                           ArrayContext& context) {
  const JsonField root = group.root();
  if (!root.has("multiscales") || !root.at("multiscales").value().is_array()) return false;
  for (const JsonField& multiscale : root.at("multiscales").elements()) {
    if (!multiscale.has("datasets")) continue;
    for (const JsonField& dataset : multiscale.at("datasets").elements())
      if (dataset.has("path") && dataset.at("path").value() == name &&
          take_transform(dataset, context))
        return true;
  }
  return false;
}

}  // namespace

ArrayContext n5_context_of(const StoreFolder& array) {
  constexpr std::size_t most_groups = 3;
  ArrayContext context;
  const auto own = attributes_of(array);
  if (!own) return context;
  context.where = own->file;
  std::vector<Attributes> above;
  std::string name;
  auto group = array.above();
  for (std::size_t i = 0; i < most_groups && group; ++i) {
    if (i == 0) name = group->name;
    if (auto attributes = attributes_of(group->folder)) above.push_back(std::move(*attributes));
    group = group->folder.above();
  }
  if (own->root().has("axes") && own->root().at("axes").value().is_array()) {
    for (const JsonField& axis : own->root().at("axes").elements())
      if (axis.value().is_string()) context.axes.push_back(axis.text());
    std::ranges::reverse(context.axes);
  }
  ArrayContext placed = context;
  placed.axes.clear();
  if (take_transform(own->root(), placed)) return placed;
  for (const Attributes& attributes : above)
    if (take_listed_transform(attributes, name, placed)) return placed;
  take_resolution(*own, level_of(name), above, context);
  return context;
}

std::optional<Pyramid> n5_pyramid_of(const StoreFolder& group) {
  constexpr std::size_t most_levels = 64;
  Pyramid pyramid;
  for (std::size_t i = 0; i < most_levels; ++i) {
    const std::string name = fmt::format("s{}", i);
    const StoreFolder folder = group / name;
    const auto text = folder.text("attributes.json");
    if (!text || !is_n5_array(*text)) break;
    const ArrayContext context = n5_context_of(folder);
    if (i == 0) pyramid.axes = context.axes;
    pyramid.where = context.where;
    pyramid.levels.push_back({name, context.scale, context.translation, context.units});
  }
  if (pyramid.levels.empty()) return std::nullopt;
  return pyramid;
}

}  // namespace voxweld
