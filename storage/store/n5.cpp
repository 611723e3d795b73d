#include "storage/store/n5.h"

#include <algorithm>

#include "storage/store/zarr_fields.h"
#include "storage/store/zarr_json.h"

namespace voxweld {
namespace {

using Json = nlohmann::ordered_json;

// N5 lists the fastest dimension first, Zarr the slowest.
Json reversed(const JsonField& list) {
  Json all = Json::array();
  for (const JsonField& element : list.elements()) all.push_back(element.value());
  std::reverse(all.begin(), all.end());
  return all;
}

Extents reversed_extents(const JsonField& list, std::size_t rank) {
  Extents extents = zarr_extents(list, rank);
  std::ranges::reverse(extents);
  return extents;
}

void parse_type(const JsonField& root, ZarrArray& array) {
  const JsonField field = root.at("dataType");
  const std::string name = field.text();
  const auto type = parse_sample_type(name);
  if (!type || sample_type_name(*type) != name)
    field.refuse("\"" + name +
                 "\" is not supported; int8 to int64, uint8 to uint64, float32 and float64 are");
  if (root.has("isLabelMultiset") && root.at("isLabelMultiset").value() == true)
    root.refuse("label multisets of Paintera are not supported; export the labels as uint64");
  array.type = *type;
}

void parse_compression(const JsonField& root, ZarrArray& array) {
  static constexpr std::pair<const char*, CompressorKind> kinds[] = {
      {"gzip", CompressorKind::gzip},      {"bzip2", CompressorKind::bz2},
      {"lz4", CompressorKind::lz4_blocks}, {"xz", CompressorKind::xz},
      {"blosc", CompressorKind::blosc},    {"zstd", CompressorKind::zstd}};
  const bool old = !root.has("compression") && root.has("compressionType");  // N5 before 2
  const JsonField field = root.at(old ? "compressionType" : "compression");
  const bool bare = field.value().is_string();
  const std::string name = bare ? field.text() : field.at("type").text();
  if (name == "raw") return;
  const auto found =
      std::ranges::find_if(kinds, [&](const auto& entry) { return entry.first == name; });
  if (found == std::end(kinds))
    field.refuse("the compression \"" + name +
                 "\" is not supported; raw, gzip, bzip2, lz4, xz, blosc and zstd are");
  Compressor compressor;
  compressor.kind = found->second;
  for (const char* level : {"level", "clevel"})
    if (!bare && field.has(level))
      compressor.level = static_cast<int>(field.at(level).integer(-131072, 22));
  if (!bare && field.has("cname")) compressor.cname = field.at("cname").text();
  array.codecs.compressor = compressor;
}

}  // namespace

bool is_n5_array(const std::string& text) {
  const Json document = Json::parse(text, nullptr, false);
  return document.is_object() && document.contains("dimensions");
}

ZarrArray parse_n5_array(const std::string& text, const std::filesystem::path& directory,
                         const ArrayContext& context) {
  const std::string file = (directory / "attributes.json").string();
  const Json document = parse_zarr_document(text, file);
  const JsonField root(document, file, "");
  ZarrArray array;
  array.path = directory;
  array.metadata = "attributes.json";
  const Json shape = reversed(root.at("dimensions"));
  settle_dimensions(JsonField(shape, file, "dimensions (the slowest first)"), context, array);
  const std::size_t rank = array.axes.size();
  parse_type(root, array);
  check_zarr_size(root.at("dimensions"), zarr_extents(root.at("dimensions"), rank),
                  sample_bytes(array.type));
  array.file = array.chunk = reversed_extents(root.at("blockSize"), rank);
  check_zarr_size(root.at("blockSize"), array.file, sample_bytes(array.type));
  array.order = columns_first(rank);
  array.n5_blocks = true;
  array.keys = {.leading_c = false, .fastest_first = true, .separator = '/'};
  array.codecs.big_endian = true;
  parse_compression(root, array);
  check_zarr_chunk(root, array);
  array.geometry = geometry_of(context, array);
  return array;
}

}  // namespace voxweld
