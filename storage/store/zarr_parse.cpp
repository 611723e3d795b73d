// zarr.json -> ZarrArray. Everything the array says is either understood or refused by name.
#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <utility>

#include "storage/store/zarr_codecs.h"
#include "storage/store/zarr_fields.h"
#include "storage/store/zarr_json.h"
#include "storage/store/zarr_metadata.h"

namespace voxweld {
namespace {

using Json = nlohmann::ordered_json;

void check_version(const JsonField& root) {
  const JsonField version = root.at("zarr_format");
  if (version.value().is_string() && version.text().find("purl.org/zarr") != std::string::npos)
    root.refuse(
        "this is an early draft of Zarr v3 (zr3), which is not Zarr v3 and is not supported; "
        "convert it to Zarr v3");
  if (version.value() != 3)
    version.refuse("3 expected, " + version.shown() + " found: unknown version of Zarr");
}

void check_node(const JsonField& root) {
  const std::string node = root.at("node_type").text();
  if (node == "group") {
    std::string hint;
    const auto& attributes =
        root.has("attributes") ? root.at("attributes").value() : nlohmann::ordered_json::object();
    if (attributes.is_object() &&
        (attributes.contains("ome") || attributes.contains("multiscales")))
      hint = " (OME-Zarr: usually \"0\" is the full resolution)";
    root.refuse("is a group, not an array; name the directory of an array inside it" + hint);
  }
  if (node != "array") root.at("node_type").refuse("\"array\" expected, \"" + node + "\" found");
}

// The specification: an unknown field must be refused unless it says it may be ignored.
void check_fields(const JsonField& root) {
  static constexpr std::string_view known[] = {
      "zarr_format",         "node_type", "shape",      "data_type",          "chunk_grid",
      "fill_value",          "codecs",    "attributes", "chunk_key_encoding", "dimension_names",
      "storage_transformers"};
  for (const auto& [name, value] : root.value().items()) {
    if (std::find(std::begin(known), std::end(known), name) != std::end(known)) continue;
    const bool optional =
        value.is_object() && value.contains("must_understand") && value["must_understand"] == false;
    if (!optional) root.refuse("the extension \"" + name + "\" is not supported");
  }
  if (!root.has("storage_transformers")) return;
  const auto transformers = root.at("storage_transformers").elements();
  if (!transformers.empty())
    transformers[0].refuse("storage transformers are not supported, " + transformers[0].shown() +
                           " found");
}

void parse_data_type(const JsonField& root, ZarrArray& array) {
  const JsonField said = root.at("data_type");
  const bool named = said.value().is_object() && !said.has("configuration");
  const JsonField field = named ? said.at("name") : said;
  const std::string name = field.value().is_string() ? field.text() : field.shown();
  array.half = name == "float16";
  if (array.half) array.type = SampleType::f32;
  if (name == "bool") array.type = SampleType::u8;
  if (array.half || name == "bool") return;
  const auto type = parse_sample_type(name);
  // Aliases of other formats ("short") are no Zarr names.
  if (!type || sample_type_name(*type) != name)
    field.refuse("\"" + name + "\" is not supported; int8 to int64, uint8 to uint64, float16 to " +
                 "float64 and bool are");
  array.type = *type;
}

// Empty where not all have one.
std::vector<std::string> dimension_names(const JsonField& root) {
  std::vector<std::string> names;
  if (!root.has("dimension_names") || root.at("dimension_names").value().is_null()) return names;
  for (const JsonField& name : root.at("dimension_names").elements()) {
    if (name.value().is_null()) return {};
    names.push_back(name.text());
  }
  return names;
}

void parse_keys(const JsonField& root, ZarrArray& array) {
  const JsonField encoding = root.at("chunk_key_encoding");
  const std::string name = encoding.at("name").text();
  if (name != "default" && name != "v2")
    encoding.refuse("\"" + name + "\" is not supported; \"default\" and \"v2\" are");
  array.keys.leading_c = name != "v2";
  array.keys.separator = name == "v2" ? '.' : '/';
  if (!encoding.has("configuration") || !encoding.at("configuration").has("separator")) return;
  const JsonField separator = encoding.at("configuration").at("separator");
  const std::string text = separator.text();
  if (text != "/" && text != ".")
    separator.refuse("\"/\" or \".\" expected, " + separator.shown() + " found");
  array.keys.separator = text[0];
}

Vec3 parse_vector(const JsonField& field) {
  const auto parts = field.elements();
  if (parts.size() != 3) field.refuse("three numbers expected, " + field.shown() + " found");
  return {parts[0].real(), parts[1].real(), parts[2].real()};
}

void parse_geometry(const JsonField& root, ZarrArray& array) {
  if (!root.has("attributes") || !root.at("attributes").has("voxweld")) return;
  const JsonField own = root.at("attributes").at("voxweld");
  VolumeGeometry geometry;
  geometry.size = array.size;
  geometry.spacing = parse_vector(own.at("spacing"));
  geometry.origin = parse_vector(own.at("origin"));
  const auto direction = own.at("direction").elements();
  if (direction.size() != 3) own.at("direction").refuse("three vectors expected");
  for (std::size_t axis = 0; axis < 3; ++axis)
    geometry.direction[axis] = parse_vector(direction[axis]);
  geometry.unit = own.at("unit").text();
  geometry.space = own.at("space").text();
  for (int axis = 0; axis < 3; ++axis)
    if (!(geometry.spacing[axis] > 0) || !std::isfinite(geometry.spacing[axis]))
      own.at("spacing").refuse("positive numbers expected, " + own.at("spacing").shown());
  array.geometry = geometry;
  if (own.has("slope") && own.has("intercept"))
    array.scale = value_scale(own.at("slope").real(), own.at("intercept").real());
}

}  // namespace

ZarrArray parse_zarr_array(const std::string& text, const std::filesystem::path& directory,
                           const ArrayContext& given) {
  const std::string file = (directory / "zarr.json").string();
  const Json document = parse_zarr_document(text, file);
  const JsonField root(document, file, "");
  check_version(root);
  check_node(root);
  check_fields(root);
  ZarrArray array;
  array.path = directory;
  ArrayContext context = given;
  if (context.axes.empty()) context.axes = dimension_names(root);
  settle_dimensions(root.at("shape"), context, array);
  const std::size_t rank = array.axes.size();
  parse_data_type(root, array);
  check_zarr_size(root.at("shape"), zarr_extents(root.at("shape"), rank), sample_bytes(array.type));
  const JsonField grid = root.at("chunk_grid");
  if (grid.at("name").value() != "regular")
    grid.refuse("\"regular\" expected, " + grid.at("name").shown() + " found: not supported");
  const JsonField shape = grid.at("configuration").at("chunk_shape");
  array.file = zarr_extents(shape, rank);
  check_zarr_size(shape, array.file, sample_bytes(array.type));
  parse_keys(root, array);
  parse_fill_value(root.at("fill_value"), array);
  parse_codecs(root, array);
  check_zarr_chunk(root, array);
  array.geometry = geometry_of(context, array);
  parse_geometry(root, array);
  return array;
}

}  // namespace voxweld
