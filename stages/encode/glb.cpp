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

constexpr int target_vertices = 34962, target_indices = 34963;
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

Json accessor(int component, std::uint64_t count, const char* type) {
  return {{"componentType", component}, {"count", count}, {"type", type}};
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

// A file in the making: its JSON, and the pieces of its binary chunk, which have to outlive it.
class GlbFile {
 public:
  explicit GlbFile(const GlbParameters& parameters) : parameters_(parameters) {}

  void add(const EncodedMesh& mesh, const std::optional<MaterialPair>& pair);
  void add(const DecodedMesh& mesh, const std::optional<MaterialPair>& pair);
  void write(const ByteSink& sink) const;

 private:
  // Returns its number.
  template <class T>
  std::size_t add_view(std::span<const T> piece, int target = 0);
  // Its indices are those of the last accessor.
  void add_primitive(const Json& attributes, const std::optional<MaterialPair>& pair,
                     const Json& extensions = nullptr);
  Json document() const;

  const GlbParameters& parameters_;
  Json accessors_ = Json::array(), primitives_ = Json::array(), materials_ = Json::array(),
       views_ = Json::array();
  std::vector<std::span<const std::byte>> pieces_;
  std::size_t size_ = 0;  // of the pieces, each but the last one padded
  bool draco_ = false;
};

template <class T>
std::size_t GlbFile::add_view(std::span<const T> piece, int target) {
  const std::size_t begin = padded(size_);
  Json& view = views_.emplace_back(
      Json{{"buffer", 0}, {"byteOffset", begin}, {"byteLength", piece.size_bytes()}});
  if (target != 0) view["target"] = target;
  pieces_.push_back(std::as_bytes(piece));
  size_ = begin + piece.size_bytes();
  return views_.size() - 1;
}

void GlbFile::add_primitive(const Json& attributes, const std::optional<MaterialPair>& pair,
                            const Json& extensions) {
  Json& primitive = primitives_.emplace_back(Json{{"attributes", attributes},
                                                  {"indices", accessors_.size() - 1},
                                                  {"material", materials_.size()},
                                                  {"mode", mode_triangles}});
  if (!extensions.is_null()) primitive["extensions"] = extensions;
  if (pair)
    primitive["extras"] = {{"inside", label_of(pair->inside)},
                           {"outside", label_of(pair->outside)}};
  materials_.push_back(material(pair, parameters_));
}

void GlbFile::add(const EncodedMesh& mesh, const std::optional<MaterialPair>& pair) {
  draco_ = true;
  Json attributes = {{"POSITION", accessors_.size()}}, ids = {{"POSITION", mesh.position_id}};
  Json& position = accessors_.emplace_back(accessor(component_float, mesh.points, "VEC3"));
  position["min"] = mesh.lo;
  position["max"] = mesh.hi;
  if (mesh.normal_id >= 0) {
    attributes["NORMAL"] = accessors_.size();
    ids["NORMAL"] = mesh.normal_id;
    accessors_.push_back(accessor(component_float, mesh.points, "VEC3"));
  }
  accessors_.push_back(accessor(component_uint32, 3 * mesh.triangles, "SCALAR"));
  const std::size_t view = add_view(std::span(mesh.bytes));
  add_primitive(attributes, pair, {{draco_extension, {{"bufferView", view}, {"attributes", ids}}}});
}

void GlbFile::add(const DecodedMesh& mesh, const std::optional<MaterialPair>& pair) {
  const auto add_accessor = [&](std::size_t view, Json added) -> Json& {
    added["bufferView"] = view;
    return accessors_.emplace_back(std::move(added));
  };
  Json attributes = {{"POSITION", accessors_.size()}};
  const auto [lo, hi] = bounds_of(mesh.positions);
  Json& position = add_accessor(add_view(std::span(mesh.positions), target_vertices),
                                accessor(component_float, mesh.positions.size(), "VEC3"));
  position["min"] = lo;
  position["max"] = hi;
  if (!mesh.normals.empty()) {
    attributes["NORMAL"] = accessors_.size();
    add_accessor(add_view(std::span(mesh.normals), target_vertices),
                 accessor(component_float, mesh.normals.size(), "VEC3"));
  }
  add_accessor(add_view(std::span(mesh.triangles), target_indices),
               accessor(component_uint32, 3 * mesh.triangles.size(), "SCALAR"));
  add_primitive(attributes, pair);
}

Json GlbFile::document() const {
  Json out;
  out["asset"] = {{"version", "2.0"}, {"generator", "voxweld " VOXWELD_VERSION}};
  if (draco_) {
    out["extensionsUsed"] = {draco_extension};
    out["extensionsRequired"] = {draco_extension};
  }
  out["scene"] = 0;
  out["scenes"] = Json::array({{{"nodes", {0}}}});
  out["nodes"] = Json::array({node(parameters_)});
  out["meshes"] = Json::array({{{"primitives", primitives_}}});
  out["materials"] = materials_;
  out["accessors"] = accessors_;
  out["bufferViews"] = views_;
  out["buffers"] = Json::array({{{"byteLength", size_}}});
  return out;
}

void put_u32(std::vector<std::byte>& out, std::uint64_t value) {
  for (int shift = 0; shift < 32; shift += 8)
    out.push_back(static_cast<std::byte>(value >> shift & 0xff));
}

void GlbFile::write(const ByteSink& sink) const {
  std::string text = json_text(document());
  text.resize(padded(text.size()), ' ');
  const std::uint64_t bin = padded(size_);
  const std::uint64_t total = header_size + 2 * chunk_header_size + text.size() + bin;
  if (total > std::numeric_limits<std::uint32_t>::max())
    throw InputError(fmt::format(
        "a glTF binary holds less than 4 GiB, the mesh takes {} bytes: write .drc or tiles",
        total));
  std::vector<std::byte> out;
  for (const std::uint64_t v : {std::uint64_t{magic}, std::uint64_t{2}, total,
                                std::uint64_t{text.size()}, std::uint64_t{json_chunk}})
    put_u32(out, v);
  const auto json = std::as_bytes(std::span(text));
  out.insert(out.end(), json.begin(), json.end());
  put_u32(out, bin);
  put_u32(out, bin_chunk);
  sink(out);
  constexpr std::array<std::byte, 4> zeros{};
  for (const auto piece : pieces_) {
    sink(piece);
    sink(std::span(zeros).first(padded(piece.size()) - piece.size()));
  }
}

std::vector<std::byte> whole(const GlbFile& file) {
  std::vector<std::byte> bytes;
  file.write([&](std::span<const std::byte> piece) {
    bytes.insert(bytes.end(), piece.begin(), piece.end());
  });
  return bytes;
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

std::array<double, 16> world_matrix(const VolumeGeometry& frame) {
  GlbParameters parameters;
  parameters.frame = frame;
  parameters.y_up = false;
  return node_matrix(parameters);
}

std::vector<std::byte> wrap_glb(const EncodedMesh& mesh, const GlbParameters& parameters) {
  GlbFile file(parameters);
  file.add(mesh, {});
  return whole(file);
}

std::vector<std::byte> wrap_glb(std::span<const GlbPart> parts, const GlbParameters& parameters) {
  GlbFile file(parameters);
  for (const GlbPart& part : parts) file.add(part.mesh, part.pair);
  return whole(file);
}

void write_plain_glb(std::span<const PlainGlbPart> parts, const GlbParameters& parameters,
                     const ByteSink& sink) {
  GlbFile file(parameters);
  for (const PlainGlbPart& part : parts) file.add(part.mesh, part.pair);
  file.write(sink);
}

}  // namespace voxweld
