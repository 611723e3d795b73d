// Based on: Khronos Group, "glTF 2.0 Specification" (2021), section "GLB File Format"; for labels as
// glb_pairs.cpp.
#include "stages/encode/glb_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "stages/encode/glb_pairs.h"
#include "stages/encode/label_colour.h"
#include "storage/support/error.h"
#include "storage/support/json_text.h"

namespace voxweld::glb {
namespace {

constexpr int mode_triangles = 4;

constexpr std::size_t padded(std::size_t size, std::size_t to = 4) {
  return (size + to - 1) / to * to;
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

void put_u32(std::vector<std::byte>& out, std::uint64_t value) {
  for (int shift = 0; shift < 32; shift += 8)
    out.push_back(static_cast<std::byte>(value >> shift & 0xff));
}

}  // namespace

std::size_t GlbFile::add_bytes(std::span<const std::byte> piece, int target,
                               std::size_t alignment) {
  const std::size_t begin = padded(size_, alignment);
  Json& view = views_.emplace_back(
      Json{{"buffer", 0}, {"byteOffset", begin}, {"byteLength", piece.size_bytes()}});
  if (target != 0) view["target"] = target;
  pieces_.push_back(piece);
  places_.push_back(begin);
  size_ = begin + piece.size_bytes();
  return views_.size() - 1;
}

std::size_t GlbFile::add_absent_view(std::span<const std::byte> piece, std::size_t bytes,
                                     Json view) {
  const std::size_t begin = padded(size_);
  Json& compressed = view.at("extensions").at(meshopt_extension);
  compressed["buffer"] = 0;
  compressed["byteOffset"] = begin;
  compressed["byteLength"] = piece.size();
  view["buffer"] = 1;
  view["byteOffset"] = absent_size_;
  view["byteLength"] = bytes;
  absent_size_ += padded(bytes);
  pieces_.push_back(piece);
  places_.push_back(begin);
  size_ = begin + piece.size();
  views_.push_back(std::move(view));
  return views_.size() - 1;
}

Json& GlbFile::add_attribute(const char* name, int component, std::uint64_t count,
                             const char* type) {
  primitive_["attributes"][name] = accessors_.size();
  return accessors_.emplace_back(accessor(component, count, type));
}

Json& GlbFile::add_corners(std::uint64_t count) {
  primitive_["indices"] = accessors_.size();
  primitive_["material"] = 0;
  primitive_["mode"] = mode_triangles;
  return accessors_.emplace_back(accessor(component_uint32, count, "SCALAR"));
}

void GlbFile::add_table(std::span<const MaterialPair> pairs) {
  Json properties, table;
  for (PairColumn& column : pair_columns(pairs, parameters_.materials)) {
    const auto add_own = [&](std::vector<std::byte>& bytes) {
      return add_view(keep(std::move(bytes)), 0, table_alignment);
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

Json GlbFile::document() const {
  Json out, mesh = {{"primitives", Json::array({primitive_})}}, placed = node(parameters_);
  out["asset"] = {{"version", "2.0"}, {"generator", "voxweld " VOXWELD_VERSION}};
  if (!required_.empty()) {
    out["extensionsUsed"] = required_;
    out["extensionsRequired"] = required_;
  }
  if (!metadata_.is_null()) {
    for (const char* extension : {features_extension, metadata_extension})
      out["extensionsUsed"].push_back(extension);
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
  if (absent_size_ > 0)
    out["buffers"].push_back({{"byteLength", absent_size_},
                              {"extensions", {{meshopt_extension, {{"fallback", true}}}}}});
  return out;
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

PointFeatures point_features(const DecodedMesh& mesh, const MaterialTable* materials) {
  const std::vector<PairColour> colours = pair_colours(mesh.pairs, materials);
  PointFeatures of;
  of.colours.resize(mesh.positions.size() * sizeof(PairColour));
  of.ids.resize(mesh.positions.size() * sizeof(float));
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const std::uint32_t pair = mesh.triangle_pairs[t];
    const auto id = static_cast<float>(pair);
    for (const std::uint32_t point : mesh.triangles[t]) {
      std::memcpy(of.colours.data() + point * sizeof(PairColour), colours[pair].data(),
                  sizeof(PairColour));
      std::memcpy(of.ids.data() + point * sizeof id, &id, sizeof id);
    }
  }
  return of;
}

}  // namespace voxweld::glb

namespace voxweld {

std::array<double, 16> world_matrix(const VolumeGeometry& frame) {
  GlbParameters parameters;
  parameters.frame = frame;
  parameters.y_up = false;
  return glb::node_matrix(parameters);
}

}  // namespace voxweld
