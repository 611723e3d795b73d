// ZarrArray -> zarr.json.
#include <nlohmann/json.hpp>

#include "storage/store/zarr_metadata.h"
#include "storage/support/file_io.h"
#include "storage/support/hash.h"
#include "storage/support/json_text.h"

namespace voxweld {
namespace {

using Json = nlohmann::ordered_json;

Json extents(Index3 v) {
  return Json::array({v.z, v.y, v.x});
}
Json extents(const Extents& v) {
  return Json(v);
}
Json vector(Vec3 v) {
  return Json::array({v.x, v.y, v.z});
}
Json codec(const char* name, Json configuration) {
  return Json{{"name", name}, {"configuration", std::move(configuration)}};
}

Json compressor_codec(const Compressor& compressor, std::size_t sample_bytes) {
  static constexpr const char* shuffles[] = {"noshuffle", "shuffle", "bitshuffle"};
  if (compressor.kind == CompressorKind::zstd)
    return codec("zstd", {{"level", compressor.level}, {"checksum", false}});
  return codec("blosc", {{"cname", compressor.cname},
                         {"clevel", compressor.level},
                         {"shuffle", shuffles[static_cast<int>(compressor.shuffle)]},
                         {"typesize", sample_bytes},
                         {"blocksize", 0}});
}

Json chunk_codecs(const ZarrArray& array) {
  Json codecs = Json::array({codec("bytes", {{"endian", "little"}})});
  if (array.codecs.compressor)
    codecs.push_back(compressor_codec(*array.codecs.compressor, sample_bytes(array.type)));
  codecs.push_back({{"name", "crc32c"}});
  return codecs;
}

Json sharding_codec(const ZarrArray& array) {
  return codec("sharding_indexed",
               {{"chunk_shape", extents(array.chunk)},
                {"codecs", chunk_codecs(array)},
                {"index_codecs",
                 Json::array({codec("bytes", {{"endian", "little"}}), Json{{"name", "crc32c"}}})},
                {"index_location", "end"}});
}

// The order of the vectors' parts is x, y, z, unlike that of shape: said in the file itself.
Json own_attributes(const VolumeGeometry& geometry, const ValueScale& scale) {
  Json direction = Json::array();
  for (const Vec3& axis : geometry.direction) direction.push_back(vector(axis));
  Json own = {{"version", 1},
              {"component_order", "x, y, z"},
              {"spacing", vector(geometry.spacing)},
              {"origin", vector(geometry.origin)},
              {"direction", std::move(direction)},
              {"unit", geometry.unit},
              {"space", geometry.space}};
  if (scale.identity()) return own;
  own["slope"] = scale.slope;
  own["intercept"] = scale.intercept;
  return own;
}

}  // namespace

std::string render_zarr_array(const ZarrArray& array) {
  Json document = {
      {"zarr_format", 3},
      {"node_type", "array"},
      {"shape", extents(array.size)},
      {"data_type", sample_type_name(array.type)},
      {"chunk_grid",
       {{"name", "regular"}, {"configuration", {{"chunk_shape", extents(array.file)}}}}},
      {"chunk_key_encoding", {{"name", "default"}, {"configuration", {{"separator", "/"}}}}},
      {"fill_value", 0},
      {"codecs", Json::array({sharding_codec(array)})},
      {"attributes",
       {{"voxweld", own_attributes(array.geometry.value_or(VolumeGeometry{}), array.scale)}}},
      {"dimension_names", Json::array({"z", "y", "x"})}};
  const std::string unsealed = json_text(document);
  document["attributes"]["voxweld"]["checksum"] = to_hex(hash_bytes(as_bytes(unsealed)));
  return json_text(document, 2) + "\n";
}

}  // namespace voxweld
