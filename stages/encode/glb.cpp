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

#include "stages/encode/glb_format.h"
#include "stages/encode/label_colour.h"
#include "storage/support/error.h"
#include "storage/support/json_text.h"

namespace voxweld {
namespace {

using namespace glb;

constexpr int component_float = 5126, component_uint32 = 5125;
constexpr int mode_triangles = 4;

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

// Adds the primitive's accessors.
Json primitive(const EncodedMesh& mesh, std::size_t view, Json& accessors) {
  Json attributes = {{"POSITION", accessors.size()}}, draco_ids = {{"POSITION", mesh.position_id}};
  Json position = vector_accessor(mesh.points);
  position["min"] = mesh.lo;
  position["max"] = mesh.hi;
  accessors.push_back(position);
  if (mesh.normal_id >= 0) {
    attributes["NORMAL"] = accessors.size();
    draco_ids["NORMAL"] = mesh.normal_id;
    accessors.push_back(vector_accessor(mesh.points));
  }
  const std::size_t indices = accessors.size();
  accessors.push_back(
      Json{{"componentType", component_uint32}, {"count", 3 * mesh.triangles}, {"type", "SCALAR"}});
  const Json extension = {{draco_extension, {{"bufferView", view}, {"attributes", draco_ids}}}};
  return {{"attributes", attributes},
          {"indices", indices},
          {"material", view},
          {"mode", mode_triangles},
          {"extensions", extension}};
}

Json label_of(Material material) {
  return material == exterior ? Json(nullptr) : Json(material);
}

std::string label_name(Material material) {
  return material == exterior ? "outside" : fmt::to_string(material);
}

Json material(const std::optional<MaterialPair>& pair, const GlbParameters& parameters) {
  Json surface = {{"metallicFactor", 0.0}, {"roughnessFactor", 0.7}};
  const Material label = pair ? pair->inside : parameters.label;
  std::optional<std::array<double, 3>> colour;
  if (parameters.materials != nullptr) colour = given_colour(*parameters.materials, label);
  if (pair && !colour) colour = label_colour(label);
  if (colour) surface["baseColorFactor"] = {(*colour)[0], (*colour)[1], (*colour)[2], 1.0};
  if (!pair) return {{"pbrMetallicRoughness", surface}, {"doubleSided", false}};
  return {{"name", label_name(pair->inside) + " | " + label_name(pair->outside)},
          {"pbrMetallicRoughness", surface},
          {"doubleSided", true}};
}

struct Part {
  const EncodedMesh* mesh = nullptr;
  std::optional<MaterialPair> pair = std::nullopt;
};

Json document(const std::vector<Part>& parts, const GlbParameters& parameters) {
  Json accessors = Json::array(), primitives = Json::array(), materials = Json::array(),
       views = Json::array();
  std::size_t offset = 0;
  for (const Part& part : parts) {
    Json& added = primitives.emplace_back(primitive(*part.mesh, views.size(), accessors));
    if (part.pair)
      added["extras"] = {{"inside", label_of(part.pair->inside)},
                         {"outside", label_of(part.pair->outside)}};
    materials.push_back(material(part.pair, parameters));
    const std::size_t size = part.mesh->bytes.size();
    views.push_back({{"buffer", 0}, {"byteOffset", offset}, {"byteLength", size}});
    offset += &part == &parts.back() ? size : padded(size);
  }
  Json out;
  out["asset"] = {{"version", "2.0"}, {"generator", "voxweld " VOXWELD_VERSION}};
  out["extensionsUsed"] = {draco_extension};
  out["extensionsRequired"] = {draco_extension};
  out["scene"] = 0;
  out["scenes"] = Json::array({{{"nodes", {0}}}});
  out["nodes"] = Json::array({node(parameters)});
  out["meshes"] = Json::array({{{"primitives", primitives}}});
  out["materials"] = materials;
  out["accessors"] = accessors;
  out["bufferViews"] = views;
  out["buffers"] = Json::array({{{"byteLength", offset}}});
  return out;
}

void put_u32(std::vector<std::byte>& out, std::uint64_t value) {
  for (int shift = 0; shift < 32; shift += 8)
    out.push_back(static_cast<std::byte>(value >> shift & 0xff));
}

std::vector<std::byte> wrap(const std::vector<Part>& parts, const GlbParameters& parameters) {
  std::string text = json_text(document(parts, parameters));
  text.resize(padded(text.size()), ' ');
  std::size_t bin = 0;
  for (const Part& part : parts) bin += padded(part.mesh->bytes.size());
  const std::uint64_t total = header_size + 2 * chunk_header_size + text.size() + bin;
  if (total > std::numeric_limits<std::uint32_t>::max())
    throw InputError(fmt::format(
        "a glTF binary holds less than 4 GiB, the mesh takes {} bytes: write .drc or tiles",
        total));
  std::vector<std::byte> out;
  out.reserve(total);
  for (const std::uint64_t v : {std::uint64_t{magic}, std::uint64_t{2}, total,
                                std::uint64_t{text.size()}, std::uint64_t{json_chunk}})
    put_u32(out, v);
  const auto json = std::as_bytes(std::span(text));
  out.insert(out.end(), json.begin(), json.end());
  put_u32(out, bin);
  put_u32(out, bin_chunk);
  for (const Part& part : parts) {
    out.insert(out.end(), part.mesh->bytes.begin(), part.mesh->bytes.end());
    out.resize(padded(out.size()), std::byte{0});
  }
  return out;
}

}  // namespace

std::optional<double> metres_per(const std::string& unit) {
  struct Unit {
    double metres;
    std::array<std::string_view, 6> names;
  };
  static constexpr Unit units[] = {
      {1, {"m", "meter", "metre"}},
      {1e-2, {"cm", "centimeter", "centimetre"}},
      {1e-3, {"mm", "millimeter", "millimetre"}},
      {1e-6, {"um", "\u00b5m", "\u03bcm", "micron", "micrometer", "micrometre"}},
      {1e-9, {"nm", "nanometer", "nanometre"}},
      {1e-10, {"angstrom"}},
      {0.0254, {"inch"}},
  };
  for (const auto& [metres, names] : units)
    if (!unit.empty() && std::ranges::find(names, unit) != names.end()) return metres;
  return std::nullopt;
}

std::vector<std::byte> wrap_glb(const EncodedMesh& mesh, const GlbParameters& parameters) {
  return wrap({Part{&mesh}}, parameters);
}

std::vector<std::byte> wrap_glb(std::span<const GlbPart> parts, const GlbParameters& parameters) {
  std::vector<Part> all;
  for (const GlbPart& part : parts) all.push_back({&part.mesh, part.pair});
  return wrap(all, parameters);
}

}  // namespace voxweld
