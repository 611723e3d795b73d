// .zarray -> ZarrArray. Everything the array says is either understood or refused by name.
#include <algorithm>
#include <bit>

#include "storage/store/ome_zarr.h"
#include "storage/store/zarr_fields.h"
#include "storage/store/zarr_json.h"
#include "storage/store/zarr_metadata.h"

namespace voxweld {
namespace {

// NumPy's: "<u2", ">f4", "|u1". Booleans are bytes of 0 and 1.
void parse_dtype(const JsonField& root, ZarrArray& array) {
  const JsonField field = root.at("dtype");
  const std::string name = field.value().is_string() ? field.text() : field.shown();
  const char order = name.empty() ? '?' : name[0];
  const std::string type = name.empty() ? "" : name.substr(1);
  static constexpr std::pair<const char*, SampleType> types[] = {
      {"u1", SampleType::u8},  {"b1", SampleType::u8},  {"i1", SampleType::i8},
      {"u2", SampleType::u16}, {"i2", SampleType::i16}, {"u4", SampleType::u32},
      {"i4", SampleType::i32}, {"u8", SampleType::u64}, {"i8", SampleType::i64},
      {"f4", SampleType::f32}, {"f8", SampleType::f64}};
  const auto found =
      std::ranges::find_if(types, [&](const auto& entry) { return entry.first == type; });
  if (found == std::end(types) || (order != '<' && order != '>' && order != '|') ||
      (order == '|' && sample_bytes(found->second) > 1))
    field.refuse("\"" + name +
                 "\" is not supported; integers of 1 to 8 bytes, \"f4\", \"f8\" and " +
                 "\"|b1\" are");
  array.type = found->second;
  array.codecs.big_endian = order == '>';
}

Compressor parse_compressor(const JsonField& field) {
  Compressor compressor;
  static constexpr std::pair<const char*, CompressorKind> kinds[] = {
      {"blosc", CompressorKind::blosc}, {"zstd", CompressorKind::zstd},
      {"zlib", CompressorKind::gzip},   {"gzip", CompressorKind::gzip},
      {"bz2", CompressorKind::bz2},     {"lz4", CompressorKind::lz4}};
  const std::string id = field.at("id").text();
  const auto found =
      std::ranges::find_if(kinds, [&](const auto& entry) { return entry.first == id; });
  if (found == std::end(kinds))
    field.refuse("the compressor \"" + id +
                 "\" is not supported; blosc, zlib, gzip, bz2, zstd and lz4 are");
  compressor.kind = found->second;
  for (const char* level : {"level", "clevel"})
    if (field.has(level)) compressor.level = static_cast<int>(field.at(level).integer(-131072, 22));
  if (field.has("cname")) compressor.cname = field.at("cname").text();
  return compressor;
}

void parse_order(const JsonField& root, ZarrArray& array) {
  const JsonField order = root.at("order");
  const std::string text = order.text();
  if (text != "C" && text != "F")
    order.refuse("\"C\" or \"F\" expected, " + order.shown() + " found");
  const std::size_t rank = array.axes.size();
  array.order = order_of(array.axes, text == "F" ? columns_first(rank) : rows_first(rank));
}

void parse_keys(const JsonField& root, ZarrArray& array) {
  array.v2_keys = true;
  array.separator = '.';
  if (!root.has("dimension_separator")) return;
  const JsonField separator = root.at("dimension_separator");
  const std::string text = separator.text();
  if (text != "/" && text != ".")
    separator.refuse("\"/\" or \".\" expected, " + separator.shown() + " found");
  array.separator = text[0];
}

}  // namespace

ZarrArray parse_zarr_v2_array(const std::string& text, const std::filesystem::path& directory,
                              const OmeDataset* image) {
  const std::string file = (directory / ".zarray").string();
  const nlohmann::ordered_json document = parse_zarr_document(text, file);
  const JsonField root(document, file, "");
  const JsonField version = root.at("zarr_format");
  if (version.value() != 2) version.refuse("2 expected, " + version.shown() + " found");
  ZarrArray array;
  array.path = directory;
  array.metadata = ".zarray";
  array.axes = zarr_axes(root.at("shape"), image ? image->axes : std::vector<std::string>());
  parse_dtype(root, array);
  array.size = zarr_extents(root.at("shape"), array.axes);
  check_zarr_size(root.at("shape"), array.size, array.type);
  array.file = array.chunk = zarr_extents(root.at("chunks"), array.axes);
  check_zarr_size(root.at("chunks"), array.file, array.type);
  parse_order(root, array);
  parse_keys(root, array);
  // No fill value: whatever the reader likes.
  if (!root.at("fill_value").value().is_null())
    array.fill = zarr_fill_value(root.at("fill_value"), array.type);
  if (root.has("filters") && !root.at("filters").value().is_null()) {
    const auto filters = root.at("filters").elements();
    if (!filters.empty())
      filters[0].refuse("filters are not supported, " + filters[0].shown() + " found");
  }
  if (!root.at("compressor").value().is_null())
    array.codecs.compressor = parse_compressor(root.at("compressor"));
  check_zarr_chunk(root, array);
  if (image) array.geometry = geometry_of(*image, array);
  return array;
}

}  // namespace voxweld
