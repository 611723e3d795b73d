// Based on: Khronos Group, "glTF 2.0 Specification" (2021), section "GLB File Format", and the
// extension specification KHR_draco_mesh_compression.
#include "stages/encode/glb.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>
#include <string_view>

#include "storage/support/error.h"

namespace voxweld {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::uint32_t glb_magic = 0x46546c67;   // "glTF"
constexpr std::uint32_t json_chunk = 0x4e4f534a;  // "JSON"
constexpr std::uint32_t bin_chunk = 0x004e4942;   // "BIN\0"
constexpr std::size_t header_size = 12, chunk_header_size = 8;
constexpr int component_float = 5126, component_uint32 = 5125;
constexpr int mode_triangles = 4;
constexpr const char* draco_extension = "KHR_draco_mesh_compression";

constexpr std::size_t padded(std::size_t size) {
  return (size + 3) / 4 * 4;
}

bool orthogonal(const VolumeGeometry& frame) {
  for (std::size_t a = 0; a < 3; ++a) {
    for (std::size_t b = a; b < 3; ++b) {
      const double expected = a == b ? 1 : 0;
      if (!(std::abs(dot(frame.direction[a], frame.direction[b]) - expected) < 1e-5)) return false;
    }
  }
  return true;
}

Vec3 turned(Vec3 v, bool y_up) {
  return y_up ? Vec3{v.x, v.z, -v.y} : v;
}

// The node's matrix, column-major.
std::array<double, 16> node_matrix(const GlbParameters& parameters) {
  std::array<Vec3, 4> columns{Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}, Vec3{0, 0, 0}};
  double scale = 1;
  if (parameters.frame) {
    const VolumeGeometry& frame = *parameters.frame;
    if (orthogonal(frame)) std::copy_n(frame.direction.begin(), 3, columns.begin());
    columns[3] = frame.origin;
    scale = metres_per(frame.unit).value_or(1);
  }
  std::array<double, 16> matrix{};
  for (std::size_t c = 0; c < 4; ++c) {
    const Vec3 v = turned(columns[c], parameters.y_up) * scale;
    // + 0.0: no negative zeros in the text.
    for (std::size_t r = 0; r < 3; ++r) matrix[4 * c + r] = v[static_cast<int>(r)] + 0.0;
  }
  matrix[15] = 1;
  return matrix;
}

Json node(const GlbParameters& parameters) {
  Json out;
  out["mesh"] = 0;
  const std::array<double, 16> matrix = node_matrix(parameters);
  const std::array<double, 16> identity{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
  if (matrix != identity) out["matrix"] = matrix;
  if (parameters.frame && !orthogonal(*parameters.frame)) {
    Json direction = Json::array();
    for (const Vec3& d : parameters.frame->direction) direction.push_back({d.x, d.y, d.z});
    out["extras"]["direction"] = direction;
  }
  return out;
}

Json vector_accessor(std::uint64_t count) {
  return {{"componentType", component_float}, {"count", count}, {"type", "VEC3"}};
}

Json document(const EncodedMesh& mesh, const GlbParameters& parameters) {
  Json attributes = {{"POSITION", 0}}, draco_ids = {{"POSITION", mesh.position_id}};
  Json position = vector_accessor(mesh.points);
  position["min"] = mesh.lo;
  position["max"] = mesh.hi;
  Json accessors = Json::array({position});
  if (mesh.normal_id >= 0) {
    attributes["NORMAL"] = accessors.size();
    draco_ids["NORMAL"] = mesh.normal_id;
    accessors.push_back(vector_accessor(mesh.points));
  }
  const std::size_t indices = accessors.size();
  accessors.push_back(
      Json{{"componentType", component_uint32}, {"count", 3 * mesh.triangles}, {"type", "SCALAR"}});
  const Json extension = {{draco_extension, {{"bufferView", 0}, {"attributes", draco_ids}}}};
  const Json primitive = {{"attributes", attributes},
                          {"indices", indices},
                          {"material", 0},
                          {"mode", mode_triangles},
                          {"extensions", extension}};
  const Json surface = {{"metallicFactor", 0.0}, {"roughnessFactor", 0.7}};
  Json out;
  out["asset"] = {{"version", "2.0"}, {"generator", "voxweld " VOXWELD_VERSION}};
  out["extensionsUsed"] = {draco_extension};
  out["extensionsRequired"] = {draco_extension};
  out["scene"] = 0;
  out["scenes"] = Json::array({{{"nodes", {0}}}});
  out["nodes"] = Json::array({node(parameters)});
  out["meshes"] = Json::array({{{"primitives", Json::array({primitive})}}});
  out["materials"] = Json::array({{{"pbrMetallicRoughness", surface}, {"doubleSided", false}}});
  out["accessors"] = accessors;
  out["bufferViews"] =
      Json::array({{{"buffer", 0}, {"byteOffset", 0}, {"byteLength", mesh.bytes.size()}}});
  out["buffers"] = Json::array({{{"byteLength", mesh.bytes.size()}}});
  return out;
}

void put_u32(std::vector<std::byte>& out, std::uint64_t value) {
  for (int shift = 0; shift < 32; shift += 8)
    out.push_back(static_cast<std::byte>(value >> shift & 0xff));
}

std::uint32_t get_u32(std::span<const std::byte> bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i)
    value |= std::to_integer<std::uint32_t>(bytes[at + i]) << (8 * i);
  return value;
}

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
  if (glb.size() < header_size || get_u32(glb, 0) != glb_magic)
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
    throw FormatError(where + ": glTF of another shape than expected: " + e.what());
  }
}

const Json& primitive_of(const Json& json) {
  return json.at("meshes").at(0).at("primitives").at(0);
}

std::span<const std::byte> draco_view(const GlbChunks& chunks, const std::string& where) {
  return with_json(where, [&] {
    const Json& extension = primitive_of(chunks.json).at("extensions").at(draco_extension);
    const Json& view =
        chunks.json.at("bufferViews").at(extension.at("bufferView").get<std::size_t>());
    const auto offset = view.value("byteOffset", std::uint64_t{0});
    const auto length = view.at("byteLength").get<std::uint64_t>();
    if (offset > chunks.bin.size() || length > chunks.bin.size() - offset)
      throw FormatError(fmt::format("{}: glTF bufferView of {} bytes at {} in a buffer of {}",
                                    where, length, offset, chunks.bin.size()));
    return chunks.bin.subspan(offset, length);
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
  std::array<float, 3> lo = mesh.positions.at(0), hi = lo;
  for (const auto& p : mesh.positions) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      lo[axis] = std::min(lo[axis], p[axis]);
      hi[axis] = std::max(hi[axis], p[axis]);
    }
  }
  if (accessor.at("min").get<std::array<float, 3>>() != lo ||
      accessor.at("max").get<std::array<float, 3>>() != hi)
    throw FormatError(where + ": the glTF accessor's min and max differ from the decoded ones");
}

}  // namespace

std::optional<double> metres_per(const std::string& unit) {
  struct Unit {
    std::string_view name;
    double metres;
  };
  static constexpr std::array<Unit, 20> units{{
      {"m", 1},
      {"meter", 1},
      {"metre", 1},
      {"cm", 1e-2},
      {"centimeter", 1e-2},
      {"centimetre", 1e-2},
      {"mm", 1e-3},
      {"millimeter", 1e-3},
      {"millimetre", 1e-3},
      {"um", 1e-6},
      {"\u00b5m", 1e-6},
      {"\u03bcm", 1e-6},
      {"micron", 1e-6},
      {"micrometer", 1e-6},
      {"micrometre", 1e-6},
      {"nm", 1e-9},
      {"nanometer", 1e-9},
      {"nanometre", 1e-9},
      {"angstrom", 1e-10},
      {"inch", 0.0254},
  }};
  for (const Unit& u : units)
    if (u.name == unit) return u.metres;
  return std::nullopt;
}

std::vector<std::byte> wrap_glb(const EncodedMesh& mesh, const GlbParameters& parameters) {
  std::string text = document(mesh, parameters).dump();
  text.resize(padded(text.size()), ' ');
  const std::size_t bin = padded(mesh.bytes.size());
  const std::uint64_t total = header_size + 2 * chunk_header_size + text.size() + bin;
  if (total > std::numeric_limits<std::uint32_t>::max())
    throw InputError(fmt::format(
        "a glTF binary holds less than 4 GiB, the mesh takes {} bytes: write .drc or tiles",
        total));
  std::vector<std::byte> out;
  out.reserve(total);
  for (const std::uint64_t v : {std::uint64_t{glb_magic}, std::uint64_t{2}, total,
                                std::uint64_t{text.size()}, std::uint64_t{json_chunk}})
    put_u32(out, v);
  const auto json = std::as_bytes(std::span(text));
  out.insert(out.end(), json.begin(), json.end());
  put_u32(out, bin);
  put_u32(out, bin_chunk);
  out.insert(out.end(), mesh.bytes.begin(), mesh.bytes.end());
  out.resize(total, std::byte{0});
  return out;
}

std::span<const std::byte> glb_draco_buffer(std::span<const std::byte> glb,
                                            const std::string& where) {
  return draco_view(parse_glb(glb, where), where);
}

DecodedMesh decode_glb(std::span<const std::byte> glb, const std::string& where) {
  const GlbChunks chunks = parse_glb(glb, where);
  DecodedMesh mesh = decode_draco(draco_view(chunks, where), where);
  with_json(where, [&] {
    const Json& primitive = primitive_of(chunks.json);
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
  });
  return mesh;
}

}  // namespace voxweld
