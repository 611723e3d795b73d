// .zarray -> ZarrArray. Everything the array says is either understood or refused by name.
#include <algorithm>

#include "storage/store/zarr_codecs.h"
#include "storage/store/zarr_fields.h"
#include "storage/store/zarr_json.h"
#include "storage/store/zarr_metadata.h"

namespace voxweld {
namespace {

// NumPy's: "<u2", ">f4", "|u1". Booleans are bytes of 0 and 1, and of 16-bit floats floats are made.
void parse_dtype(const JsonField& root, ZarrArray& array) {
  const JsonField field = root.at("dtype");
  const std::string name = field.value().is_string() ? field.text() : field.shown();
  const char order = name.empty() ? '?' : name[0];
  const std::string type = name.empty() ? "" : name.substr(1);
  static constexpr std::pair<const char*, SampleType> types[] = {
      {"u1", SampleType::u8},  {"b1", SampleType::u8},  {"i1", SampleType::i8},
      {"u2", SampleType::u16}, {"i2", SampleType::i16}, {"u4", SampleType::u32},
      {"i4", SampleType::i32}, {"u8", SampleType::u64}, {"i8", SampleType::i64},
      {"f2", SampleType::f32}, {"f4", SampleType::f32}, {"f8", SampleType::f64}};
  const auto found =
      std::ranges::find_if(types, [&](const auto& entry) { return entry.first == type; });
  if (found == std::end(types) || (order != '<' && order != '>' && order != '|') ||
      (order == '|' && sample_bytes(found->second) > 1))
    field.refuse("\"" + name +
                 "\" is not supported; integers of 1 to 8 bytes, \"f2\" to \"f8\" and " +
                 "\"|b1\" are");
  array.type = found->second;
  array.half = type == "f2";
  array.codecs.big_endian = order == '>';
}

void parse_order(const JsonField& root, ZarrArray& array) {
  const JsonField order = root.at("order");
  const std::string text = order.text();
  if (text != "C" && text != "F")
    order.refuse("\"C\" or \"F\" expected, " + order.shown() + " found");
  const std::size_t rank = array.axes.size();
  array.order = text == "F" ? rows_first(rank) : columns_first(rank);
}

void parse_separator(const JsonField& root, ZarrArray& array) {
  array.keys.leading_c = false;
  array.keys.separator = '.';
  if (!root.has("dimension_separator")) return;
  const JsonField separator = root.at("dimension_separator");
  const std::string text = separator.text();
  if (text != "/" && text != ".")
    separator.refuse("\"/\" or \".\" expected, " + separator.shown() + " found");
  array.keys.separator = text[0];
}

}  // namespace

std::vector<std::string> zarr_v2_names(const StoreFolder& array) {
  const char* key = "_ARRAY_DIMENSIONS";
  const auto text = array.text(".zattrs");
  if (!text) return {};
  const std::string file = (array / ".zattrs").name();
  const nlohmann::ordered_json document = parse_zarr_document(*text, file);
  const JsonField root(document, file, "");
  if (!root.has(key)) return {};
  std::vector<std::string> names;
  for (const JsonField& name : root.at(key).elements()) names.push_back(name.text());
  return names;
}

ZarrArray parse_zarr_v2_array(const std::string& text, const std::filesystem::path& directory,
                              const ArrayContext& context) {
  const std::string file = (directory / ".zarray").string();
  const nlohmann::ordered_json document = parse_zarr_document(text, file);
  const JsonField root(document, file, "");
  const JsonField version = root.at("zarr_format");
  if (version.value() != 2) version.refuse("2 expected, " + version.shown() + " found");
  ZarrArray array;
  array.path = directory;
  array.metadata = ".zarray";
  settle_dimensions(root.at("shape"), context, array);
  const std::size_t rank = array.axes.size();
  parse_dtype(root, array);
  check_zarr_size(root.at("shape"), zarr_extents(root.at("shape"), rank), sample_bytes(array.type));
  array.file = array.chunk = zarr_extents(root.at("chunks"), rank);
  check_zarr_size(root.at("chunks"), array.file, sample_bytes(array.type));
  parse_order(root, array);
  parse_separator(root, array);
  // No fill value: whatever the reader likes.
  if (!root.at("fill_value").value().is_null()) parse_fill_value(root.at("fill_value"), array);
  if (root.has("filters") && !root.at("filters").value().is_null()) {
    const auto filters = root.at("filters").elements();
    if (!filters.empty())
      filters[0].refuse("filters are not supported, " + filters[0].shown() + " found");
  }
  if (!root.at("compressor").value().is_null())
    array.codecs.compressor =
        parse_numcodecs_compressor(root.at("compressor"), root.at("compressor").at("id").text());
  check_zarr_chunk(root, array);
  array.geometry = geometry_of(context, array);
  return array;
}

}  // namespace voxweld
