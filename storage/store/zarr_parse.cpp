// zarr.json -> ZarrArray. Everything the array says is either understood or refused by name.
#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <utility>

#include "storage/store/ome_zarr.h"
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

SampleType parse_data_type(const JsonField& root) {
  const JsonField field = root.at("data_type");
  const std::string name = field.value().is_string() ? field.text() : field.shown();
  const auto type = parse_sample_type(name);
  // Aliases of other formats ("short") are no Zarr names.
  if (!type || sample_type_name(*type) != name)
    field.refuse("\"" + name + "\" is not supported; int8 to int64, uint8 to uint64, float32 and " +
                 "float64 are");
  return *type;
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
  array.v2_keys = name == "v2";
  array.separator = array.v2_keys ? '.' : '/';
  if (!encoding.has("configuration") || !encoding.at("configuration").has("separator")) return;
  const JsonField separator = encoding.at("configuration").at("separator");
  const std::string text = separator.text();
  if (text != "/" && text != ".")
    separator.refuse("\"/\" or \".\" expected, " + separator.shown() + " found");
  array.separator = text[0];
}

bool parse_endian(const JsonField& codec, SampleType type) {
  const bool said = codec.has("configuration") && codec.at("configuration").has("endian");
  if (!said) {
    if (sample_bytes(type) > 1) codec.refuse("no \"endian\" in its configuration");
    return false;
  }
  const JsonField endian = codec.at("configuration").at("endian");
  const std::string text = endian.text();
  if (text != "little" && text != "big")
    endian.refuse("\"little\" or \"big\" expected, " + endian.shown() + " found");
  return text == "big";
}

// The dimensions of the transposed array, slowest first.
std::vector<int> parse_transpose(const JsonField& codec, std::size_t rank) {
  const JsonField field = codec.at("configuration").at("order");
  if (field.value() == "C") return rows_first(rank);
  if (field.value() == "F") return columns_first(rank);
  std::vector<int> dimensions;
  for (const JsonField& element : field.elements())
    dimensions.push_back(static_cast<int>(element.integer(0, static_cast<int>(rank) - 1)));
  std::vector<int> sorted = dimensions;
  std::ranges::sort(sorted);
  if (sorted != rows_first(rank))
    field.refuse(fmt::format("each of the {} dimensions once expected", rank));
  return dimensions;
}

Compressor parse_compressor(const JsonField& codec, const std::string& name) {
  Compressor compressor;
  compressor.kind = name == "blosc"  ? CompressorKind::blosc
                    : name == "zstd" ? CompressorKind::zstd
                                     : CompressorKind::gzip;
  if (!codec.has("configuration")) return compressor;
  const JsonField configuration = codec.at("configuration");
  if (compressor.kind != CompressorKind::blosc) {
    if (configuration.has("level"))
      compressor.level = static_cast<int>(configuration.at("level").integer(-131072, 22));
    return compressor;
  }
  compressor.cname = configuration.at("cname").text();
  compressor.level = static_cast<int>(configuration.at("clevel").integer(0, 9));
  const JsonField shuffle = configuration.at("shuffle");
  const std::string text = shuffle.text();
  if (text != "noshuffle" && text != "shuffle" && text != "bitshuffle")
    shuffle.refuse("\"noshuffle\", \"shuffle\" or \"bitshuffle\" expected, " + shuffle.shown() +
                   " found");
  compressor.shuffle = text == "noshuffle" ? Shuffle::none
                       : text == "shuffle" ? Shuffle::byte
                                           : Shuffle::bit;
  return compressor;
}

// The codecs of one chunk: [transpose] bytes [crc32c ...] [compressor] [crc32c ...].
CodecChain parse_chain(std::span<const JsonField> codecs, ZarrArray& array, const JsonField& list) {
  CodecChain chain;
  bool bytes = false, transposed = false;
  array.order = order_of(array.axes, rows_first(array.axes.size()));
  for (const JsonField& codec : codecs) {
    const std::string name = codec.value().is_string() ? codec.text() : codec.at("name").text();
    if (name == "transpose" && !bytes) {
      if (transposed) codec.refuse("a second \"transpose\" is not supported");
      transposed = true;
      array.order = order_of(array.axes, parse_transpose(codec, array.axes.size()));
    } else if (name == "bytes" && !bytes) {
      chain.big_endian = parse_endian(codec, array.type);
      bytes = true;
    } else if (name == "crc32c" && bytes) {
      ++(chain.compressor ? chain.checksums_outside : chain.checksums_inside);
    } else if ((name == "blosc" || name == "zstd" || name == "gzip") && bytes) {
      if (chain.compressor) codec.refuse("a second compressor is not supported");
      chain.compressor = parse_compressor(codec, name);
    } else {
      codec.refuse("the codec \"" + name + "\" is not supported here");
    }
  }
  if (!bytes) list.refuse("no \"bytes\" codec in it");
  return chain;
}

void parse_index(const JsonField& configuration, ZarrArray& array) {
  const JsonField list = configuration.at("index_codecs");
  ZarrArray as_index;
  as_index.type = SampleType::u64;
  const CodecChain chain = parse_chain(list.elements(), as_index, list);
  if (chain.compressor) list.refuse("a compressed shard index is not supported");
  array.index.big_endian = chain.big_endian;
  array.index.checksums = chain.checksums_inside;
  array.index.at_end = true;
  if (!configuration.has("index_location")) return;
  const JsonField location = configuration.at("index_location");
  const std::string text = location.text();
  if (text != "start" && text != "end")
    location.refuse("\"start\" or \"end\" expected, " + location.shown() + " found");
  array.index.at_end = text == "end";
}

// No real shard comes near; more would overflow the size of its index.
void check_index_size(const JsonField& field, const ZarrArray& array) {
  const Index3 grid = array.chunks_in_file();
  constexpr std::int64_t most = std::int64_t{1} << 32;
  if (grid.x > most / grid.y || grid.x * grid.y > most / grid.z)
    field.refuse(field.shown() + " makes more than 2^32 chunks a shard");
}

void parse_codecs(const JsonField& root, ZarrArray& array) {
  const JsonField list = root.at("codecs");
  const auto codecs = list.elements();
  const auto named = [](const JsonField& codec, const char* name) {
    return codec.value().is_object() && codec.has("name") && codec.at("name").value() == name;
  };
  const auto shard = std::find_if(codecs.begin(), codecs.end(), [&](const JsonField& codec) {
    return named(codec, "sharding_indexed");
  });
  array.sharded = shard != codecs.end();
  if (!array.sharded) {
    array.chunk = array.file;
    array.codecs = parse_chain(codecs, array, list);
    return;
  }
  for (auto before = codecs.begin(); before != shard; ++before)
    if (!named(*before, "transpose") ||
        parse_transpose(*before, array.axes.size()) != rows_first(array.axes.size()))
      before->refuse("the codec before \"sharding_indexed\" is not supported: " + before->shown());
  if (shard + 1 != codecs.end())
    (shard + 1)->refuse("a codec after \"sharding_indexed\" is not supported: " +
                        (shard + 1)->shown());
  const JsonField configuration = shard->at("configuration");
  const JsonField chunk = configuration.at("chunk_shape");
  array.chunk = zarr_extents(chunk, array.axes);
  for (int axis = 0; axis < 3; ++axis)
    if (array.file[axis] % array.chunk[axis] != 0)
      chunk.refuse(chunk.shown() + " does not divide the shard's shape");
  check_index_size(chunk, array);
  const JsonField inner = configuration.at("codecs");
  array.codecs = parse_chain(inner.elements(), array, inner);
  parse_index(configuration, array);
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
                           const OmeDataset* image) {
  const std::string file = (directory / "zarr.json").string();
  const Json document = parse_zarr_document(text, file);
  const JsonField root(document, file, "");
  check_version(root);
  check_node(root);
  check_fields(root);
  ZarrArray array;
  array.path = directory;
  array.axes = zarr_axes(root.at("shape"), image ? image->axes : dimension_names(root));
  array.type = parse_data_type(root);
  array.size = zarr_extents(root.at("shape"), array.axes);
  check_zarr_size(root.at("shape"), array.size, array.type);
  const JsonField grid = root.at("chunk_grid");
  if (grid.at("name").value() != "regular")
    grid.refuse("\"regular\" expected, " + grid.at("name").shown() + " found: not supported");
  const JsonField shape = grid.at("configuration").at("chunk_shape");
  array.file = zarr_extents(shape, array.axes);
  check_zarr_size(shape, array.file, array.type);
  parse_keys(root, array);
  array.fill = zarr_fill_value(root.at("fill_value"), array.type);
  parse_codecs(root, array);
  check_zarr_chunk(root, array);
  if (image) array.geometry = geometry_of(*image, array);
  parse_geometry(root, array);
  return array;
}

}  // namespace voxweld
