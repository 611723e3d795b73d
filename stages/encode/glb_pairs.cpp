// Based on: the extension specifications EXT_mesh_features and EXT_structural_metadata, and Cesium's
// "3D Metadata Specification", section "Binary Table Format".
#include "stages/encode/glb_pairs.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "stages/encode/label_colour.h"
#include "storage/support/error.h"

namespace voxweld::glb {
namespace {

void put_number(std::vector<std::byte>& out, std::uint64_t value, std::size_t size) {
  for (std::size_t i = 0; i < size; ++i)
    out.push_back(static_cast<std::byte>(value >> (8 * i) & 0xff));
}

// Outside all labels is the number with all bits set: of signed numbers -1.
struct LabelType {
  const char* name;
  std::size_t size;
  std::uint64_t most;  // without that
};
constexpr LabelType label_types[] = {
    {"INT8", 1, 0x7f},           {"INT16", 2, 0x7fff},
    {"INT32", 4, 0x7fffffff},    {"INT64", 8, 0x7fffffffffffffff},
    {"UINT64", 8, exterior - 1},
};

using Side = Material MaterialPair::*;

std::uint64_t highest_label(std::span<const MaterialPair> pairs) {
  std::uint64_t highest = 0;
  for (const MaterialPair& pair : pairs)
    for (const Material label : {pair.inside, pair.outside})
      if (label != exterior) highest = std::max(highest, label);
  return highest;
}

PairColumn number_column(const char* name, const char* what, std::span<const MaterialPair> pairs,
                         Side side) {
  const LabelType& type = *std::ranges::find_if(
      label_types, [&](const LabelType& t) { return highest_label(pairs) <= t.most; });
  PairColumn column{
      name, {{"name", what}, {"type", "SCALAR"}, {"componentType", type.name}}, {}, {}};
  // 2^64 - 1 is no number that JSON's readers keep.
  if (type.most != exterior - 1) column.property["noData"] = -1;
  column.property["required"] = true;
  for (const MaterialPair& pair : pairs) put_number(column.values, pair.*side, type.size);
  return column;
}

std::string name_of(Material label, const MaterialTable* materials) {
  const MaterialEntry* entry = materials == nullptr ? nullptr : materials->find(label);
  return entry == nullptr ? "" : entry->name;
}

// No values where none has a name.
PairColumn name_column(const char* name, const char* what, std::span<const MaterialPair> pairs,
                       Side side, const MaterialTable* materials) {
  PairColumn column{name, {{"name", what}, {"type", "STRING"}, {"noData", ""}}, {}, {}};
  put_number(column.offsets, 0, 4);
  for (const MaterialPair& pair : pairs) {
    const std::string text = name_of(pair.*side, materials);
    const auto bytes = std::as_bytes(std::span(text));
    column.values.insert(column.values.end(), bytes.begin(), bytes.end());
    if (column.values.size() > std::numeric_limits<std::uint32_t>::max())
      throw InputError("the names of labels take more than the 4 GiB that a glTF holds");
    put_number(column.offsets, column.values.size(), 4);
  }
  return column;
}

std::uint8_t eight_bits(double level) {
  return static_cast<std::uint8_t>(std::lround(level * 255));
}

std::array<double, 3> linear_colour(Material label, const MaterialTable* materials) {
  const auto given = materials == nullptr ? std::nullopt : given_colour(*materials, label);
  return given ? *given : label_colour(label);
}

MaterialColor table_colour(Material label, const MaterialTable* materials) {
  const MaterialEntry* entry = materials == nullptr ? nullptr : materials->find(label);
  if (entry != nullptr && entry->color) return *entry->color;
  if (label == exterior) return {255, 255, 255};
  const auto level = [](double linear) {  // IEC 61966-2-1
    return eight_bits(linear <= 0.0031308 ? 12.92 * linear
                                          : 1.055 * std::pow(linear, 1 / 2.4) - 0.055);
  };
  const auto [red, green, blue] = label_colour(label);
  return {level(red), level(green), level(blue)};
}

PairColumn colour_column(const char* name, const char* what, std::span<const MaterialPair> pairs,
                         Side side, const MaterialTable* materials) {
  PairColumn column{name,
                    {{"name", what},
                     {"description", "sRGB"},
                     {"type", "VEC3"},
                     {"componentType", "UINT8"},
                     {"normalized", true}},
                    {},
                    {}};
  for (const MaterialPair& pair : pairs) {
    const MaterialColor colour = table_colour(pair.*side, materials);
    for (const std::uint8_t level : {colour.red, colour.green, colour.blue})
      column.values.push_back(std::byte{level});
  }
  return column;
}

std::vector<Material> read_labels(const Json& metadata, const Json& table, const char* name,
                                  std::uint64_t count, const ViewOf& view_of,
                                  const std::string& where) {
  const auto type = metadata.at("schema")
                        .at("classes")
                        .at(table.at("class").get<std::string>())
                        .at("properties")
                        .at(name)
                        .at("componentType")
                        .get<std::string>();
  const auto found = std::ranges::find(label_types, type, &LabelType::name);
  if (found == std::end(label_types))
    throw FormatError(fmt::format("{}: glTF labels of component type {}", where, type));
  const auto bytes = view_of(table.at("properties").at(name).at("values").get<std::size_t>());
  if (bytes.size() % found->size != 0 || bytes.size() / found->size != count)
    throw FormatError(fmt::format("{}: {} glTF labels of {} bytes in a view of {} bytes", where,
                                  count, found->size, bytes.size()));
  std::vector<Material> labels;
  for (std::size_t i = 0; i < count; ++i) {
    Material label = 0;
    for (std::size_t b = 0; b < found->size; ++b)
      label |= std::to_integer<Material>(bytes[i * found->size + b]) << (8 * b);
    labels.push_back(label > found->most ? exterior : label);
  }
  return labels;
}

}  // namespace

std::vector<PairColumn> pair_columns(std::span<const MaterialPair> pairs,
                                     const MaterialTable* materials) {
  constexpr Side inside = &MaterialPair::inside, outside = &MaterialPair::outside;
  std::vector<PairColumn> columns;
  columns.push_back(number_column("inside", "Label that normals point out of", pairs, inside));
  columns.push_back(number_column("outside", "Label on the other side", pairs, outside));
  columns.push_back(name_column("inside_name", "Name of inside", pairs, inside, materials));
  columns.push_back(name_column("outside_name", "Name of outside", pairs, outside, materials));
  std::erase_if(columns, [](const PairColumn& column) { return column.values.empty(); });
  columns.push_back(colour_column("inside_color", "Color of inside", pairs, inside, materials));
  columns.push_back(colour_column("outside_color", "Color of outside", pairs, outside, materials));
  return columns;
}

std::vector<PairColour> pair_colours(std::span<const MaterialPair> pairs,
                                     const MaterialTable* materials) {
  std::vector<PairColour> colours;
  colours.reserve(pairs.size());
  for (const MaterialPair& pair : pairs) {
    const auto [red, green, blue] = linear_colour(pair.inside, materials);
    colours.push_back({eight_bits(red), eight_bits(green), eight_bits(blue), 255});
  }
  return colours;
}

std::vector<MaterialPair> read_pair_table(const Json& document, const Json& primitive,
                                          const ViewOf& view_of, const std::string& where) {
  const Json& ids = primitive.at("extensions").at(features_extension).at("featureIds").at(0);
  if (ids.at("attribute").get<int>() != 0)
    throw FormatError(where + ": glTF feature ids of another attribute than " + feature_attribute);
  const Json& metadata = document.at("extensions").at(metadata_extension);
  const Json& table = metadata.at("propertyTables").at(ids.at("propertyTable").get<std::size_t>());
  const auto count = table.at("count").get<std::uint64_t>();
  if (ids.at("featureCount").get<std::uint64_t>() != count)
    throw FormatError(fmt::format("{}: {} glTF features, and a table of {} rows", where,
                                  ids.at("featureCount").get<std::uint64_t>(), count));
  const auto inside = read_labels(metadata, table, "inside", count, view_of, where);
  const auto outside = read_labels(metadata, table, "outside", count, view_of, where);
  std::vector<MaterialPair> pairs;
  for (std::size_t i = 0; i < count; ++i) pairs.push_back({inside[i], outside[i]});
  return pairs;
}

}  // namespace voxweld::glb
