// Based on: Khronos Group, "glTF 2.0 Specification" (2021), section "GLB File Format", and the
// extension specification KHR_draco_mesh_compression; for labels as glb_pairs.cpp.
#include "stages/encode/glb.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <deque>
#include <limits>
#include <nlohmann/json.hpp>
#include <string_view>

#include "stages/encode/glb_format.h"
#include "stages/encode/glb_pairs.h"
#include "stages/encode/label_colour.h"
#include "storage/support/error.h"
#include "storage/support/json_text.h"

namespace voxweld {
namespace {

using namespace glb;

constexpr int target_vertices = 34962, target_indices = 34963;
constexpr int mode_triangles = 4;

constexpr std::size_t padded(std::size_t size, std::size_t to = 4) {
  return (size + to - 1) / to * to;
}
// Of the columns of tables, which may be of 64 bits: in the file, and so of the chunks too.
constexpr std::size_t table_alignment = 8;

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

// What the label is called, if it has a name: else the file is that of a run for this label alone.
std::string label_name(const GlbParameters& parameters) {
  const MaterialTable* table = parameters.materials;
  const MaterialEntry* entry = table == nullptr ? nullptr : table->find(parameters.label);
  return entry == nullptr ? "" : entry->name;
}

// Between labels both sides are seen, in the colours of the points.
Json material(const GlbParameters& parameters, bool between_labels) {
  Json surface = {{"metallicFactor", 0.0}, {"roughnessFactor", 0.7}};
  if (parameters.materials != nullptr && !between_labels)
    if (const auto colour = given_colour(*parameters.materials, parameters.label))
      surface["baseColorFactor"] = {(*colour)[0], (*colour)[1], (*colour)[2], 1.0};
  return {{"pbrMetallicRoughness", surface}, {"doubleSided", between_labels}};
}

int component_of(FeatureIdType type) {
  return type == FeatureIdType::u8    ? component_uint8
         : type == FeatureIdType::u16 ? component_uint16
                                      : component_float;
}

// A file in the making: its JSON, and the pieces of its binary chunk, which have to outlive it.
class GlbFile {
 public:
  explicit GlbFile(const GlbParameters& parameters) : parameters_(parameters) {}

  void add(const EncodedMesh& mesh, std::span<const MaterialPair> pairs);
  void add(const DecodedMesh& mesh);
  void write(const ByteSink& sink);

 private:
  // Returns its number.
  template <class T>
  std::size_t add_view(std::span<const T> piece, int target = 0, std::size_t alignment = 4);
  // An accessor without a view, or of an attribute of points in a view of its own.
  Json& add_accessor(const char* attribute, int component, std::uint64_t count, const char* type);
  template <class T>
  Json& add_attribute(const char* attribute, std::span<const T> values, int component,
                      const char* type);
  void add_feature_ids(const DecodedMesh& mesh);
  void add_table(std::span<const MaterialPair> pairs);
  // Its corners are those of the last accessor.
  void finish_primitive();
  Json document() const;

  const GlbParameters& parameters_;
  Json accessors_ = Json::array(), views_ = Json::array();
  Json primitive_ = Json::object(), metadata_ = nullptr;
  std::vector<std::span<const std::byte>> pieces_;
  std::vector<std::size_t> places_;  // where each piece begins
  std::deque<std::vector<std::byte>> own_;
  std::size_t size_ = 0;  // of the pieces, each but the last one padded
};

template <class T>
std::size_t GlbFile::add_view(std::span<const T> piece, int target, std::size_t alignment) {
  const std::size_t begin = padded(size_, alignment);
  Json& view = views_.emplace_back(
      Json{{"buffer", 0}, {"byteOffset", begin}, {"byteLength", piece.size_bytes()}});
  if (target != 0) view["target"] = target;
  pieces_.push_back(std::as_bytes(piece));
  places_.push_back(begin);
  size_ = begin + piece.size_bytes();
  return views_.size() - 1;
}

Json& GlbFile::add_accessor(const char* attribute, int component, std::uint64_t count,
                            const char* type) {
  primitive_["attributes"][attribute] = accessors_.size();
  return accessors_.emplace_back(accessor(component, count, type));
}

template <class T>
Json& GlbFile::add_attribute(const char* attribute, std::span<const T> values, int component,
                             const char* type) {
  Json& added = add_accessor(attribute, component, values.size(), type);
  added["bufferView"] = add_view(values, target_vertices);
  return added;
}

void GlbFile::add(const EncodedMesh& mesh, std::span<const MaterialPair> pairs) {
  Json ids;
  const auto add_of_draco = [&](const char* attribute, int id, int component,
                                const char* type) -> Json& {
    ids[attribute] = id;
    return add_accessor(attribute, component, mesh.points, type);
  };
  Json& position = add_of_draco("POSITION", mesh.position_id, component_float, "VEC3");
  position["min"] = mesh.lo;
  position["max"] = mesh.hi;
  if (mesh.normal_id >= 0) add_of_draco("NORMAL", mesh.normal_id, component_float, "VEC3");
  if (!pairs.empty()) {
    add_of_draco("COLOR_0", mesh.colour_id, component_uint8, "VEC4")["normalized"] = true;
    add_of_draco(feature_attribute, mesh.pair_id, component_of(feature_id_type(pairs.size())),
                 "SCALAR");
  }
  accessors_.push_back(accessor(component_uint32, 3 * mesh.triangles, "SCALAR"));
  finish_primitive();
  const std::size_t view = add_view(std::span(mesh.bytes));
  primitive_["extensions"][draco_extension] = {{"bufferView", view}, {"attributes", ids}};
  if (!pairs.empty()) add_table(pairs);
}

void GlbFile::add(const DecodedMesh& mesh) {
  const auto [lo, hi] = bounds_of(mesh.positions);
  Json& position = add_attribute("POSITION", std::span(mesh.positions), component_float, "VEC3");
  position["min"] = lo;
  position["max"] = hi;
  if (!mesh.normals.empty())
    add_attribute("NORMAL", std::span(mesh.normals), component_float, "VEC3");
  if (!mesh.pairs.empty()) add_feature_ids(mesh);
  const std::size_t view = add_view(std::span(mesh.triangles), target_indices);
  accessors_.push_back(accessor(component_uint32, 3 * mesh.triangles.size(), "SCALAR"));
  accessors_.back()["bufferView"] = view;
  finish_primitive();
  if (!mesh.pairs.empty()) add_table(mesh.pairs);
}

// As floats: what is less than 32 bits would have to be padded to that.
void GlbFile::add_feature_ids(const DecodedMesh& mesh) {
  const std::vector<PairColour> colours = pair_colours(mesh.pairs, parameters_.materials);
  std::vector<std::byte>& of_points = own_.emplace_back(mesh.positions.size() * sizeof(PairColour));
  std::vector<std::byte>& ids = own_.emplace_back(mesh.positions.size() * sizeof(float));
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const std::uint32_t pair = mesh.triangle_pairs[t];
    const auto id = static_cast<float>(pair);
    for (const std::uint32_t point : mesh.triangles[t]) {
      std::memcpy(of_points.data() + point * sizeof(PairColour), colours[pair].data(),
                  sizeof(PairColour));
      std::memcpy(ids.data() + point * sizeof id, &id, sizeof id);
    }
  }
  const auto add_own = [&](const char* attribute, const std::vector<std::byte>& values,
                           int component, const char* type) -> Json& {
    Json& added = add_accessor(attribute, component, mesh.positions.size(), type);
    added["bufferView"] = add_view(std::span(values), target_vertices);
    return added;
  };
  add_own("COLOR_0", of_points, component_uint8, "VEC4")["normalized"] = true;
  add_own(feature_attribute, ids, component_float, "SCALAR");
}

void GlbFile::add_table(std::span<const MaterialPair> pairs) {
  Json properties, table;
  for (PairColumn& column : pair_columns(pairs, parameters_.materials)) {
    const auto add_own = [&](std::vector<std::byte>& bytes) {
      const std::vector<std::byte>& kept = own_.emplace_back(std::move(bytes));
      return add_view(std::span(kept), 0, table_alignment);
    };
    properties[column.name] = column.property;
    table[column.name]["values"] = add_own(column.values);
    if (!column.offsets.empty()) table[column.name]["stringOffsets"] = add_own(column.offsets);
  }
  metadata_["schema"] = {
      {"id", "voxweld"},
      {"classes",
       {{pair_class, {{"name", "What a triangle separates"}, {"properties", properties}}}}}};
  metadata_["propertyTables"] =
      Json::array({{{"class", pair_class}, {"count", pairs.size()}, {"properties", table}}});
  primitive_["extensions"][features_extension]["featureIds"] =
      Json::array({{{"featureCount", pairs.size()}, {"attribute", 0}, {"propertyTable", 0}}});
}

void GlbFile::finish_primitive() {
  primitive_["indices"] = accessors_.size() - 1;
  primitive_["material"] = 0;
  primitive_["mode"] = mode_triangles;
}

Json GlbFile::document() const {
  Json out, mesh = {{"primitives", Json::array({primitive_})}}, placed = node(parameters_);
  out["asset"] = {{"version", "2.0"}, {"generator", "voxweld " VOXWELD_VERSION}};
  if (primitive_.contains("extensions")) {
    for (const auto& [name, what] : primitive_["extensions"].items())
      out["extensionsUsed"].push_back(name);
    if (primitive_["extensions"].contains(draco_extension))
      out["extensionsRequired"] = {draco_extension};
  }
  if (!metadata_.is_null()) {
    out["extensionsUsed"].push_back(metadata_extension);
    out["extensions"][metadata_extension] = metadata_;
  }
  if (const std::string name = label_name(parameters_); !name.empty()) {
    mesh["name"] = placed["name"] = name;
    placed["extras"]["label"] = parameters_.label;
  }
  out["scene"] = 0;
  out["scenes"] = Json::array({{{"nodes", {0}}}});
  out["nodes"] = Json::array({placed});
  out["meshes"] = Json::array({mesh});
  out["materials"] = Json::array({material(parameters_, !metadata_.is_null())});
  out["accessors"] = accessors_;
  out["bufferViews"] = views_;
  out["buffers"] = Json::array({{{"byteLength", size_}}});
  return out;
}

void put_u32(std::vector<std::byte>& out, std::uint64_t value) {
  for (int shift = 0; shift < 32; shift += 8)
    out.push_back(static_cast<std::byte>(value >> shift & 0xff));
}

void GlbFile::write(const ByteSink& sink) {
  const std::size_t alignment = metadata_.is_null() ? 4 : table_alignment;
  if (!metadata_.is_null()) size_ = padded(size_, alignment);
  std::string text = json_text(document());
  const std::size_t before = header_size + chunk_header_size;
  text.resize(padded(before + text.size(), alignment) - before, ' ');
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
  constexpr std::array<std::byte, table_alignment> zeros{};
  for (std::size_t i = 0; i < pieces_.size(); ++i) {
    sink(pieces_[i]);
    const std::size_t end = i + 1 < pieces_.size() ? places_[i + 1] : bin;
    sink(std::span(zeros).first(end - places_[i] - pieces_[i].size()));
  }
}

std::vector<std::byte> whole(GlbFile& file) {
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

std::vector<std::byte> wrap_glb(const EncodedMesh& mesh, const GlbParameters& parameters,
                                std::span<const MaterialPair> pairs) {
  GlbFile file(parameters);
  file.add(mesh, pairs);
  return whole(file);
}

void write_plain_glb(const DecodedMesh& mesh, const GlbParameters& parameters,
                     const ByteSink& sink) {
  GlbFile file(parameters);
  file.add(mesh);
  file.write(sink);
}

}  // namespace voxweld
