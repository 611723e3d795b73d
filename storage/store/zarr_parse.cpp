// zarr.json -> ZarrArray. Everything the array says is either understood or refused by name.
#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <string_view>
#include <type_traits>

#include "storage/store/zarr_json.h"
#include "storage/store/zarr_metadata.h"
#include "storage/support/refused_text.h"

namespace voxweld {
namespace {

constexpr std::int64_t largest_extent = std::int64_t{1} << 40;

void check_version(const JsonField& root) {
  const JsonField version = root.at("zarr_format");
  if (version.value().is_string() && version.text().find("purl.org/zarr") != std::string::npos)
    root.refuse(
        "this is an early draft of Zarr v3 (zr3), which is not Zarr v3 and is not supported; "
        "convert it to Zarr v3");
  if (version.value() == 2) root.refuse("Zarr v2 is not supported yet; convert it to Zarr v3");
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

// Zarr's extents, slowest first, as x, y, z.
Index3 parse_extents(const JsonField& field, int rank) {
  const auto extents = field.elements();
  if (static_cast<int>(extents.size()) != rank)
    field.refuse(fmt::format("{} extents expected, {} found", rank, field.shown()));
  Index3 result = splat(1);
  for (int axis = 0; axis < rank; ++axis)
    result[axis] = extents[static_cast<std::size_t>(rank - 1 - axis)].integer(1, largest_extent);
  return result;
}

void check_size(const JsonField& field, Index3 extents, SampleType type) {
  std::int64_t bytes = static_cast<std::int64_t>(sample_bytes(type));
  for (int axis = 0; axis < 3; ++axis)
    if (__builtin_mul_overflow(bytes, extents[axis], &bytes))
      field.refuse(field.shown() + " is more than 2^63 bytes");
}

int parse_rank(const JsonField& root) {
  const JsonField shape = root.at("shape");
  const std::size_t rank = shape.elements().size();
  if (rank != 2 && rank != 3)
    shape.refuse(fmt::format(
        "{} dimensions are not supported, 3 (z, y, x) expected; extract one volume first", rank));
  return static_cast<int>(rank);
}

template <class T>
using BitsOf = std::conditional_t<sizeof(T) == 4, std::uint32_t, std::uint64_t>;

template <class T>
T parse_special_fill(const JsonField& field) {
  const std::string text = field.text();
  if (text == "NaN") return std::numeric_limits<T>::quiet_NaN();
  if (text == "Infinity") return std::numeric_limits<T>::infinity();
  if (text == "-Infinity") return -std::numeric_limits<T>::infinity();
  if (text.size() == 2 + 2 * sizeof(T) && text.starts_with("0x")) {
    BitsOf<T> bits = 0;
    const auto [end, error] = std::from_chars(text.data() + 2, text.data() + text.size(), bits, 16);
    if (error == std::errc() && end == text.data() + text.size()) return std::bit_cast<T>(bits);
  }
  field.refuse(fmt::format(
      "a number, \"NaN\", \"Infinity\", \"-Infinity\" or \"0x\" and {} digits expected, {} found",
      2 * sizeof(T), field.shown()));
}

template <class T>
T parse_whole_fill(const JsonField& field) {
  const auto& value = field.value();
  const auto wrong = [&] {
    field.refuse(fmt::format("an integer from {} to {} expected, {} found",
                             std::numeric_limits<T>::min(), std::numeric_limits<T>::max(),
                             field.shown()));
  };
  if (value.is_number_unsigned()) {
    const auto v = value.get<std::uint64_t>();
    if (v > static_cast<std::uint64_t>(std::numeric_limits<T>::max())) wrong();
    return static_cast<T>(v);
  }
  if (!value.is_number_integer()) wrong();
  const auto v = value.get<std::int64_t>();  // negative: others are unsigned
  if (std::is_unsigned_v<T> ? v < 0 : v < static_cast<std::int64_t>(std::numeric_limits<T>::min()))
    wrong();
  return static_cast<T>(v);
}

// Numbers, "NaN", "Infinity", "-Infinity" and hexadecimal bit patterns; one sample in native byte
// order.
std::array<std::byte, 8> parse_fill_value(const JsonField& field, SampleType type) {
  std::array<std::byte, 8> fill{};
  dispatch_sample_type(type, [&](auto tag) {
    using T = typename decltype(tag)::type;
    T value{};
    if constexpr (std::is_floating_point_v<T>)
      value =
          field.value().is_number() ? static_cast<T>(field.real()) : parse_special_fill<T>(field);
    else
      value = parse_whole_fill<T>(field);
    std::memcpy(fill.data(), &value, sizeof value);
  });
  return fill;
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

void check_transpose(const JsonField& codec, int rank) {
  const JsonField order = codec.at("configuration").at("order");
  if (order.value() == "C") return;
  const auto axes = order.elements();
  bool identity = static_cast<int>(axes.size()) == rank;
  for (std::size_t i = 0; i < axes.size(); ++i)
    identity = identity && axes[i].value() == static_cast<int>(i);
  if (!identity)
    order.refuse("transposed chunks are not supported, " + order.shown() +
                 " found; rewrite the array in C order");
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
CodecChain parse_chain(std::span<const JsonField> codecs, const ZarrArray& array,
                       const JsonField& list) {
  CodecChain chain;
  bool bytes = false;
  for (const JsonField& codec : codecs) {
    const std::string name = codec.value().is_string() ? codec.text() : codec.at("name").text();
    if (name == "transpose" && !bytes) {
      check_transpose(codec, array.rank);
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
    if (named(*before, "transpose"))
      check_transpose(*before, array.rank);
    else
      before->refuse("the codec before \"sharding_indexed\" is not supported: " + before->shown());
  if (shard + 1 != codecs.end())
    (shard + 1)->refuse("a codec after \"sharding_indexed\" is not supported: " +
                        (shard + 1)->shown());
  const JsonField configuration = shard->at("configuration");
  const JsonField chunk = configuration.at("chunk_shape");
  array.chunk = parse_extents(chunk, array.rank);
  for (int axis = 0; axis < 3; ++axis)
    if (array.file[axis] % array.chunk[axis] != 0)
      chunk.refuse(chunk.shown() + " does not divide the shard's shape");
  check_index_size(chunk, array);
  const JsonField inner = configuration.at("codecs");
  array.codecs = parse_chain(inner.elements(), array, inner);
  parse_index(configuration, array);
}

// A chunk is decoded whole. What fits this may still be over the caller's budget, who is told by
// largest_decode; what does not is no real array.
void check_chunk_size(const JsonField& root, const ZarrArray& array) {
  constexpr std::uint64_t most = std::uint64_t{1} << 40;
  if (array.form().bytes > most)
    root.refuse(
        fmt::format("one chunk takes {} bytes decoded, at most 2^40 are supported; rewrite "
                    "the array with smaller chunks",
                    array.form().bytes));
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

ZarrArray parse_zarr_array(const std::string& text, const std::filesystem::path& directory) {
  const std::string file = (directory / "zarr.json").string();
  using Json = nlohmann::ordered_json;
  Json document;
  // Copying and printing a value recurse: a document made to be deep must not exhaust the stack.
  const auto check_depth = [&](int depth, Json::parse_event_t, Json&) {
    if (depth > 64) throw FormatError(file + ": nested more than 64 deep, which no zarr.json is");
    return true;
  };
  try {
    document = Json::parse(text, check_depth);
  } catch (const nlohmann::json::exception& error) {
    throw FormatError(file + ": not valid JSON: " + json_problem(error));
  }
  const JsonField root(document, file, "");
  check_version(root);
  check_node(root);
  check_fields(root);
  ZarrArray array;
  array.path = directory;
  array.rank = parse_rank(root);
  array.type = parse_data_type(root);
  array.size = parse_extents(root.at("shape"), array.rank);
  check_size(root.at("shape"), array.size, array.type);
  const JsonField grid = root.at("chunk_grid");
  if (grid.at("name").value() != "regular")
    grid.refuse("\"regular\" expected, " + grid.at("name").shown() + " found: not supported");
  const JsonField shape = grid.at("configuration").at("chunk_shape");
  array.file = parse_extents(shape, array.rank);
  check_size(shape, array.file, array.type);
  parse_keys(root, array);
  array.fill = parse_fill_value(root.at("fill_value"), array.type);
  parse_codecs(root, array);
  check_chunk_size(root, array);
  parse_geometry(root, array);
  return array;
}

}  // namespace voxweld
