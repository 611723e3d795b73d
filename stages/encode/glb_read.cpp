// Based on: as glb.cpp.
#include <fmt/format.h>

#include <cmath>
#include <cstring>

#include "stages/encode/glb.h"
#include "stages/encode/glb_format.h"
#include "stages/encode/glb_meshopt.h"
#include "stages/encode/glb_pairs.h"
#include "storage/support/byte_order.h"
#include "storage/support/error.h"
#include "storage/support/refused_text.h"

namespace voxweld {
namespace {

using namespace glb;

std::uint32_t get_u32(std::span<const std::byte> bytes, std::size_t at) {
  return load_as<std::uint32_t>(bytes.data(), at, std::endian::little);
}

// NOLINTNEXTLINE(bugprone-exception-escape): to move a Json throws nothing
struct GlbChunks {
  Json json;
  std::span<const std::byte> bin;
};

std::span<const std::byte> take_chunk(std::span<const std::byte>& rest, std::uint32_t type,
                                      const std::string& where) {
  if (rest.size() < chunk_header_size)
    throw FormatError(where + ": truncated glTF binary: a chunk is missing");
  const std::uint32_t length = get_u32(rest, 0), found = get_u32(rest, 4);
  if (found != type)
    throw FormatError(
        fmt::format("{}: glTF chunk of type {:#x}, expected {:#x}", where, found, type));
  if (length > rest.size() - chunk_header_size)
    throw FormatError(fmt::format("{}: truncated glTF binary: a chunk of {} bytes, {} are left",
                                  where, length, rest.size() - chunk_header_size));
  const auto chunk = rest.subspan(chunk_header_size, length);
  rest = rest.subspan(chunk_header_size + length);
  return chunk;
}

GlbChunks parse_glb(std::span<const std::byte> glb, const std::string& where) {
  if (glb.size() < header_size || get_u32(glb, 0) != magic)
    throw FormatError(where + ": not a glTF binary: it does not start with \"glTF\"");
  if (get_u32(glb, 4) != 2)
    throw FormatError(fmt::format("{}: glTF version {}, expected 2", where, get_u32(glb, 4)));
  if (get_u32(glb, 8) != glb.size())
    throw FormatError(fmt::format("{}: glTF binary of {} bytes states {}: truncated or damaged",
                                  where, glb.size(), get_u32(glb, 8)));
  std::span<const std::byte> rest = glb.subspan(header_size);
  const auto text = take_chunk(rest, json_chunk, where);
  const char* first = reinterpret_cast<const char*>(text.data());
  GlbChunks chunks;
  chunks.json = Json::parse(first, first + text.size(), nullptr, false);
  if (chunks.json.is_discarded())
    throw FormatError(where + ": damaged glTF binary: its JSON does not parse");
  chunks.bin = take_chunk(rest, bin_chunk, where);
  return chunks;
}

// Calls read(), turning whatever JSON has to say about wrong keys and types into a FormatError.
template <class Read>
auto with_json(const std::string& where, Read read) {
  try {
    return read();
  } catch (const Json::exception& e) {
    throw FormatError(where + ": glTF of another shape than expected: " + json_problem(e));
  }
}

// The only one.
const Json& primitive_of(const Json& json, const std::string& where) {
  const Json& primitives = json.at("meshes").at(0).at("primitives");
  if (primitives.size() != 1)
    throw FormatError(fmt::format(
        "{}: {} glTF primitives, expected one; if an older voxweld wrote it, run it again", where,
        primitives.size()));
  return primitives.at(0);
}

// place: a view, or what says where its compressed bytes are.
std::span<const std::byte> piece_of(const GlbChunks& chunks, const Json& place,
                                    const std::string& where) {
  const auto offset = place.value("byteOffset", std::uint64_t{0});
  const auto length = place.at("byteLength").get<std::uint64_t>();
  if (place.at("buffer").get<int>() != 0 || offset > chunks.bin.size() ||
      length > chunks.bin.size() - offset)
    throw FormatError(fmt::format("{}: glTF bufferView of {} bytes at {} in a buffer of {}", where,
                                  length, offset, chunks.bin.size()));
  return chunks.bin.subspan(offset, length);
}

std::span<const std::byte> view_of(const GlbChunks& chunks, std::size_t number,
                                   const std::string& where) {
  return piece_of(chunks, chunks.json.at("bufferViews").at(number), where);
}

// The accessor's items, as write_plain_glb and write_meshopt_glb write them: in a view of their own.
template <class Item>
std::vector<Item> items_of(const GlbChunks& chunks, const Json& accessor, std::uint64_t count,
                           const std::string& where) {
  const Json& view = chunks.json.at("bufferViews").at(accessor.at("bufferView").get<std::size_t>());
  std::vector<std::byte> decoded;
  std::span<const std::byte> bytes;
  if (view.contains("extensions")) {
    const Json& compressed = view.at("extensions").at(meshopt_extension);
    bytes = decoded = decode_meshopt_view(view, piece_of(chunks, compressed, where), where);
  } else {
    bytes = piece_of(chunks, view, where);
  }
  if (accessor.contains("byteOffset") || bytes.size() / sizeof(Item) != count ||
      bytes.size() % sizeof(Item) != 0)
    throw FormatError(
        fmt::format("{}: a glTF accessor of {} items of {} bytes in a view of {} bytes", where,
                    count, sizeof(Item), bytes.size()));
  std::vector<Item> items(count);
  std::memcpy(items.data(), bytes.data(), bytes.size());
  return items;
}

void check_type(const Json& accessor, int component, const char* type, const std::string& where) {
  const auto found = accessor.at("componentType").get<int>();
  const auto shape = accessor.at("type").get<std::string>();
  if (found != component || shape != type)
    throw FormatError(
        fmt::format("{}: a glTF accessor of component type {} and type {}, expected "
                    "{} and {}",
                    where, found, shape, component, type));
}

std::vector<MaterialPair> pair_table(const GlbChunks& chunks, const Json& primitive,
                                     const std::string& where) {
  const auto view = [&](std::size_t number) { return view_of(chunks, number, where); };
  return read_pair_table(chunks.json, primitive, view, where);
}

// The three points of a triangle have its feature id.
void read_feature_ids(const GlbChunks& chunks, const Json& primitive, DecodedMesh& mesh,
                      const std::string& where) {
  const Json& number = primitive.at("attributes").at(feature_attribute);
  const Json& accessor = chunks.json.at("accessors").at(number.get<std::size_t>());
  check_type(accessor, component_float, "SCALAR", where);
  const auto ids = items_of<float>(chunks, accessor, mesh.positions.size(), where);
  mesh.pairs = pair_table(chunks, primitive, where);
  for (const auto& [a, b, c] : mesh.triangles) {
    const float id = ids[a];
    if (ids[b] != id || ids[c] != id)
      throw FormatError(where + ": the corners of a triangle have different glTF feature ids");
    if (!(id >= 0 && id < static_cast<float>(mesh.pairs.size())) || id != std::floor(id))
      throw FormatError(fmt::format("{}: a glTF feature id of {}, and {} features", where, id,
                                    mesh.pairs.size()));
    mesh.triangle_pairs.push_back(static_cast<std::uint32_t>(id));
  }
}

// Floats, or the integers of a meshopt_extension's filter.
std::vector<std::array<float, 3>> read_normals(const GlbChunks& chunks, const Json& accessor,
                                               const std::string& where) {
  const auto count = accessor.at("count").get<std::uint64_t>();
  if (accessor.at("componentType").get<int>() == component_float) {
    check_type(accessor, component_float, "VEC3", where);
    return items_of<std::array<float, 3>>(chunks, accessor, count, where);
  }
  check_type(accessor, component_int16, "VEC3", where);
  std::vector<std::array<float, 3>> normals;
  for (const auto& n : items_of<std::array<std::int16_t, 4>>(chunks, accessor, count, where)) {
    const auto part = [&](std::size_t i) { return std::max(n[i] / 32767.0F, -1.0F); };
    normals.push_back({part(0), part(1), part(2)});
  }
  return normals;
}

DecodedMesh read_plain(const GlbChunks& chunks, const Json& primitive, const std::string& where) {
  const Json& accessors = chunks.json.at("accessors");
  DecodedMesh mesh;
  const Json& attributes = primitive.at("attributes");
  const Json& position = accessors.at(attributes.at("POSITION").get<std::size_t>());
  check_type(position, component_float, "VEC3", where);
  mesh.positions = items_of<std::array<float, 3>>(chunks, position,
                                                  position.at("count").get<std::uint64_t>(), where);
  if (attributes.contains("NORMAL"))
    mesh.normals =
        read_normals(chunks, accessors.at(attributes.at("NORMAL").get<std::size_t>()), where);
  const Json& indices = accessors.at(primitive.at("indices").get<std::size_t>());
  check_type(indices, component_uint32, "SCALAR", where);
  const auto corners = indices.at("count").get<std::uint64_t>();
  if (corners % 3 != 0)
    throw FormatError(fmt::format("{}: {} corners of triangles in a glTF", where, corners));
  mesh.triangles = items_of<std::array<std::uint32_t, 3>>(chunks, indices, corners / 3, where);
  for (const auto& t : mesh.triangles)
    for (const std::uint32_t v : t)
      if (v >= mesh.positions.size())
        throw FormatError(
            fmt::format("{}: a triangle has vertex {} of {}", where, v, mesh.positions.size()));
  if (mesh.positions.empty() || mesh.triangles.empty())
    throw FormatError(where + ": a glTF primitive without triangles");
  if (attributes.contains(feature_attribute)) read_feature_ids(chunks, primitive, mesh, where);
  return mesh;
}

DecodedMesh read_draco(const GlbChunks& chunks, const Json& primitive, const std::string& where) {
  const Json& draco = primitive.at("extensions").at(draco_extension);
  const auto bytes = view_of(chunks, draco.at("bufferView").get<std::size_t>(), where);
  const Json& ids = draco.at("attributes");
  if (!ids.contains(feature_attribute)) return decode_draco(bytes, where);
  const PairList features{ids.at(feature_attribute).get<int>(),
                          pair_table(chunks, primitive, where)};
  return decode_draco_features(bytes, features, where);
}

DecodedMesh read_mesh(const GlbChunks& chunks, const Json& primitive, const std::string& where) {
  const bool compressed =
      primitive.contains("extensions") && primitive.at("extensions").contains(draco_extension);
  return compressed ? read_draco(chunks, primitive, where) : read_plain(chunks, primitive, where);
}

void check_count(const Json& accessor, std::uint64_t expected, const std::string& what,
                 const std::string& where) {
  const auto count = accessor.at("count").get<std::uint64_t>();
  if (count != expected)
    throw FormatError(fmt::format("{}: the glTF accessor of {} states {}, decoded are {}", where,
                                  what, count, expected));
}

void check_bounds(const Json& accessor, const DecodedMesh& mesh, const std::string& where) {
  const auto [lo, hi] = bounds_of(mesh.positions);
  if (accessor.at("min").get<std::array<float, 3>>() != lo ||
      accessor.at("max").get<std::array<float, 3>>() != hi)
    throw FormatError(where + ": the glTF accessor's min and max differ from the decoded ones");
}

// That what the accessors state is what decodes.
void check_accessors(const GlbChunks& chunks, const Json& primitive, const DecodedMesh& mesh,
                     const std::string& where) {
  const Json& accessors = chunks.json.at("accessors");
  const Json& attributes = primitive.at("attributes");
  for (const auto& [name, number] : attributes.items())
    check_count(accessors.at(number.get<std::size_t>()), mesh.positions.size(), name, where);
  check_bounds(accessors.at(attributes.at("POSITION").get<std::size_t>()), mesh, where);
  check_count(accessors.at(primitive.at("indices").get<std::size_t>()), 3 * mesh.triangles.size(),
              "corners", where);
  if (attributes.contains("NORMAL") != !mesh.normals.empty())
    throw FormatError(where + ": glTF normals are stated and missing, or the other way round");
}

}  // namespace

DecodedMesh decode_glb(std::span<const std::byte> glb, const std::string& where) {
  const GlbChunks chunks = parse_glb(glb, where);
  return with_json(where, [&] {
    const Json& primitive = primitive_of(chunks.json, where);
    DecodedMesh mesh = read_mesh(chunks, primitive, where);
    check_accessors(chunks, primitive, mesh, where);
    return mesh;
  });
}

}  // namespace voxweld
