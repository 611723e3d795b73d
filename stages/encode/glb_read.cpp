// Based on: as glb.cpp.
#include <fmt/format.h>

#include <cstring>

#include "stages/encode/glb.h"
#include "stages/encode/glb_format.h"
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

const Json& primitives_of(const Json& json) {
  return json.at("meshes").at(0).at("primitives");
}

std::span<const std::byte> view_of(const GlbChunks& chunks, std::size_t number,
                                   const std::string& where) {
  const Json& view = chunks.json.at("bufferViews").at(number);
  const auto offset = view.value("byteOffset", std::uint64_t{0});
  const auto length = view.at("byteLength").get<std::uint64_t>();
  if (offset > chunks.bin.size() || length > chunks.bin.size() - offset)
    throw FormatError(fmt::format("{}: glTF bufferView of {} bytes at {} in a buffer of {}", where,
                                  length, offset, chunks.bin.size()));
  return chunks.bin.subspan(offset, length);
}

// The accessor's items, each of three numbers: as write_plain_glb writes them, in a view of their own.
template <class Item>
std::vector<Item> items_of(const GlbChunks& chunks, const Json& accessor, std::uint64_t count,
                           const std::string& where) {
  const auto bytes = view_of(chunks, accessor.at("bufferView").get<std::size_t>(), where);
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

DecodedMesh read_plain(const GlbChunks& chunks, const Json& primitive, const std::string& where) {
  const Json& accessors = chunks.json.at("accessors");
  const auto read = [&](const Json& number) -> std::vector<std::array<float, 3>> {
    const Json& accessor = accessors.at(number.get<std::size_t>());
    check_type(accessor, component_float, "VEC3", where);
    return items_of<std::array<float, 3>>(chunks, accessor,
                                          accessor.at("count").get<std::uint64_t>(), where);
  };
  DecodedMesh mesh;
  const Json& attributes = primitive.at("attributes");
  mesh.positions = read(attributes.at("POSITION"));
  if (attributes.contains("NORMAL")) mesh.normals = read(attributes.at("NORMAL"));
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
  return mesh;
}

DecodedMesh read_mesh(const GlbChunks& chunks, std::size_t number, const std::string& where) {
  return with_json(where, [&] {
    const Json& primitive = primitives_of(chunks.json).at(number);
    if (!primitive.contains("extensions")) return read_plain(chunks, primitive, where);
    const Json& draco = primitive.at("extensions").at(draco_extension);
    return decode_draco(view_of(chunks, draco.at("bufferView").get<std::size_t>(), where), where);
  });
}

void check_count(const Json& accessor, std::uint64_t expected, const char* what,
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

DecodedMesh decode_primitive(const GlbChunks& chunks, std::size_t number,
                             const std::string& where) {
  DecodedMesh mesh = read_mesh(chunks, number, where);
  with_json(where, [&] {
    const Json& primitive = primitives_of(chunks.json).at(number);
    const Json& accessors = chunks.json.at("accessors");
    const Json& attributes = primitive.at("attributes");
    const Json& position = accessors.at(attributes.at("POSITION").get<std::size_t>());
    check_count(position, mesh.positions.size(), "positions", where);
    check_bounds(position, mesh, where);
    check_count(accessors.at(primitive.at("indices").get<std::size_t>()), 3 * mesh.triangles.size(),
                "indices", where);
    if (attributes.contains("NORMAL"))
      check_count(accessors.at(attributes.at("NORMAL").get<std::size_t>()), mesh.normals.size(),
                  "normals", where);
    if (!primitive.contains("extras")) return;
    const Json& extras = primitive.at("extras");
    const auto material = [](const Json& label) {
      return label.is_null() ? exterior : label.get<Material>();
    };
    mesh.pairs.push_back({material(extras.at("inside")), material(extras.at("outside"))});
    mesh.triangle_pairs.assign(mesh.triangles.size(), 0);
  });
  return mesh;
}

void append(const DecodedMesh& part, DecodedMesh& mesh) {
  const auto points = static_cast<std::uint32_t>(mesh.positions.size());
  const auto pairs = static_cast<std::uint32_t>(mesh.pairs.size());
  mesh.positions.insert(mesh.positions.end(), part.positions.begin(), part.positions.end());
  mesh.normals.insert(mesh.normals.end(), part.normals.begin(), part.normals.end());
  mesh.pairs.insert(mesh.pairs.end(), part.pairs.begin(), part.pairs.end());
  for (auto triangle : part.triangles) {
    for (std::uint32_t& corner : triangle) corner += points;
    mesh.triangles.push_back(triangle);
  }
  for (const std::uint32_t pair : part.triangle_pairs) mesh.triangle_pairs.push_back(pairs + pair);
}

}  // namespace

DecodedMesh decode_glb(std::span<const std::byte> glb, const std::string& where) {
  const GlbChunks chunks = parse_glb(glb, where);
  const std::size_t count = with_json(where, [&] { return primitives_of(chunks.json).size(); });
  DecodedMesh mesh = decode_primitive(chunks, 0, where);
  for (std::size_t i = 1; i < count; ++i) append(decode_primitive(chunks, i, where), mesh);
  return mesh;
}

}  // namespace voxweld
