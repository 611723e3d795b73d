#include "storage/store/zarr_codecs.h"

#include <algorithm>
#include <optional>
#include <span>

#include "storage/store/zarr_fields.h"

namespace voxweld {
namespace {

bool parse_endian(const JsonField& codec, std::size_t sample_bytes) {
  const bool said = codec.has("configuration") && codec.at("configuration").has("endian");
  if (!said) {
    if (sample_bytes > 1) codec.refuse("no \"endian\" in its configuration");
    return false;
  }
  const JsonField endian = codec.at("configuration").at("endian");
  const std::string text = endian.text();
  if (text != "little" && text != "big")
    endian.refuse("\"little\" or \"big\" expected, " + endian.shown() + " found");
  return text == "big";
}

// The dimensions of the transposed array, slowest first, of the `before` ones.
std::vector<int> parse_transpose(const JsonField& codec, const std::vector<int>& before) {
  const std::size_t rank = before.size();
  const JsonField field = codec.at("configuration").at("order");
  std::vector<int> places;
  if (field.value() == "C" || field.value() == "F")
    places = field.value() == "C" ? rows_first(rank) : columns_first(rank);
  else
    for (const JsonField& element : field.elements())
      places.push_back(static_cast<int>(element.integer(0, static_cast<int>(rank) - 1)));
  std::vector<int> sorted = places;
  std::ranges::sort(sorted);
  if (sorted != rows_first(rank))
    field.refuse(fmt::format("each of the {} dimensions once expected", rank));
  std::vector<int> dimensions;
  for (const int place : places) dimensions.push_back(before[static_cast<std::size_t>(place)]);
  return dimensions;
}

Compressor parse_blosc(const JsonField& configuration) {
  Compressor compressor;
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

// Of Zarr's own, and those of numcodecs that go by its name. Nothing where it is none of them.
std::optional<Compressor> parse_compressor(const JsonField& codec, const std::string& name) {
  const bool configured = codec.has("configuration");
  const std::string prefix = "numcodecs.";
  if (name.starts_with(prefix)) {
    static constexpr const char* known[] = {"blosc", "zstd", "zlib", "gzip", "bz2", "lz4", "lzma"};
    const std::string id = name.substr(prefix.size());
    if (std::ranges::find(known, id) == std::end(known)) return std::nullopt;
    return parse_numcodecs_compressor(configured ? codec.at("configuration") : codec, id);
  }
  if (name == "blosc") return configured ? parse_blosc(codec.at("configuration")) : Compressor{};
  if (name != "zstd" && name != "gzip") return std::nullopt;
  Compressor compressor;
  compressor.kind = name == "zstd" ? CompressorKind::zstd : CompressorKind::gzip;
  if (configured && codec.at("configuration").has("level"))
    compressor.level = static_cast<int>(codec.at("configuration").at("level").integer(-131072, 22));
  return compressor;
}

std::string codec_name(const JsonField& codec) {
  return codec.value().is_string() ? codec.text() : codec.at("name").text();
}

// What a list of codecs is read to.
struct Chain {
  CodecChain codecs;
  std::vector<int> dimensions;  // as the samples lie, slowest first
};

// The codecs of one chunk: [transpose ...] bytes [crc32c ...] [compressor] [crc32c ...]. Of the
// samples' dimensions as they come in, slowest first.
Chain parse_chain(std::span<const JsonField> codecs, std::vector<int> dimensions,
                  std::size_t sample_bytes, const JsonField& list) {
  Chain chain{{}, std::move(dimensions)};
  bool bytes = false;
  for (const JsonField& codec : codecs) {
    const std::string name = codec_name(codec);
    if (name == "transpose" && !bytes) {
      chain.dimensions = parse_transpose(codec, chain.dimensions);
    } else if (name == "bytes" && !bytes) {
      chain.codecs.big_endian = parse_endian(codec, sample_bytes);
      bytes = true;
    } else if (name == "crc32c" && bytes) {
      ++(chain.codecs.compressor ? chain.codecs.checksums_outside : chain.codecs.checksums_inside);
    } else if (auto compressor = bytes ? parse_compressor(codec, name) : std::nullopt) {
      if (chain.codecs.compressor) codec.refuse("a second compressor is not supported");
      chain.codecs.compressor = std::move(compressor);
    } else {
      codec.refuse("the codec \"" + name + "\" is not supported here");
    }
  }
  if (!bytes) list.refuse("no \"bytes\" codec in it");
  return chain;
}

ShardIndexForm parse_index(const JsonField& configuration) {
  const JsonField list = configuration.at("index_codecs");
  const CodecChain chain = parse_chain(list.elements(), {0}, sizeof(std::uint64_t), list).codecs;
  if (chain.compressor) list.refuse("a compressed shard index is not supported");
  ShardIndexForm form{true, chain.big_endian, chain.checksums_inside};
  if (!configuration.has("index_location")) return form;
  const JsonField location = configuration.at("index_location");
  const std::string text = location.text();
  if (text != "start" && text != "end")
    location.refuse("\"start\" or \"end\" expected, " + location.shown() + " found");
  form.at_end = text == "end";
  return form;
}

// Extents that are listed in the order of `dimensions`, put in the order of the array's.
Extents parse_inner_shape(const JsonField& field, const std::vector<int>& dimensions,
                          const Extents& outer) {
  const Extents listed = zarr_extents(field, dimensions.size());
  Extents extents(listed.size());
  std::int64_t pieces = 1;
  constexpr std::int64_t most = std::int64_t{1} << 32;  // no real shard comes near
  for (std::size_t i = 0; i < listed.size(); ++i) {
    const auto d = static_cast<std::size_t>(dimensions[i]);
    extents[d] = listed[i];
    if (outer[d] % listed[i] != 0)
      field.refuse(field.shown() + " does not divide the shard's shape");
    if (pieces > most / (outer[d] / listed[i]))
      field.refuse(field.shown() + " makes more than 2^32 chunks a shard");
    pieces *= outer[d] / listed[i];
  }
  return extents;
}

// A list that has a sharding_indexed in it goes one level down.
void parse_level(const JsonField& list, std::vector<int> dimensions, ZarrArray& array) {
  constexpr std::size_t most_levels = 4;
  const auto codecs = list.elements();
  const auto shard = std::ranges::find_if(
      codecs, [](const JsonField& codec) { return codec_name(codec) == "sharding_indexed"; });
  if (shard == codecs.end()) {
    Chain chain = parse_chain(codecs, std::move(dimensions), array.stored_bytes(), list);
    array.codecs = std::move(chain.codecs);
    array.order.assign(chain.dimensions.rbegin(), chain.dimensions.rend());
    array.chunk = array.piece(array.shards.size());
    return;
  }
  if (array.shards.size() == most_levels)
    shard->refuse("shards more than 4 deep are not supported");
  for (auto before = codecs.begin(); before != shard; ++before) {
    if (codec_name(*before) != "transpose")
      before->refuse("the codec before \"sharding_indexed\" is not supported: " + before->shown());
    dimensions = parse_transpose(*before, dimensions);
  }
  if (shard + 1 != codecs.end())
    (shard + 1)->refuse("a codec after \"sharding_indexed\" is not supported: " +
                        (shard + 1)->shown());
  const JsonField configuration = shard->at("configuration");
  const Extents outer = array.piece(array.shards.size());
  array.shards.push_back(
      {parse_inner_shape(configuration.at("chunk_shape"), dimensions, outer), dimensions, {}});
  array.shards.back().index = parse_index(configuration);
  parse_level(configuration.at("codecs"), std::move(dimensions), array);
}

}  // namespace

void parse_codecs(const JsonField& root, ZarrArray& array) {
  array.shards.clear();
  parse_level(root.at("codecs"), rows_first(array.axes.size()), array);
}

Compressor parse_numcodecs_compressor(const JsonField& field, const std::string& id) {
  static constexpr std::pair<const char*, CompressorKind> kinds[] = {
      {"blosc", CompressorKind::blosc}, {"zstd", CompressorKind::zstd},
      {"zlib", CompressorKind::gzip},   {"gzip", CompressorKind::gzip},
      {"bz2", CompressorKind::bz2},     {"lz4", CompressorKind::lz4},
      {"lzma", CompressorKind::xz}};
  const auto found =
      std::ranges::find_if(kinds, [&](const auto& entry) { return entry.first == id; });
  if (found == std::end(kinds))
    field.refuse("the compressor \"" + id +
                 "\" is not supported; blosc, zlib, gzip, bz2, zstd, lz4 and lzma are");
  Compressor compressor;
  compressor.kind = found->second;
  for (const char* level : {"level", "clevel"})
    if (field.has(level)) compressor.level = static_cast<int>(field.at(level).integer(-131072, 22));
  if (field.has("cname")) compressor.cname = field.at("cname").text();
  constexpr int xz = 1, lzma_alone = 2;  // Python's numbers; 3 has no header
  if (id == "lzma" && field.has("format") && field.at("format").value() != xz &&
      field.at("format").value() != lzma_alone)
    field.at("format").refuse("1 (xz) or 2 (lzma) expected, " + field.at("format").shown() +
                              " found: not supported");
  return compressor;
}

}  // namespace voxweld
