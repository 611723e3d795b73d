// Based on: as glb_file.cpp, and the extension specification KHR_draco_mesh_compression.
#include "stages/encode/glb.h"

#include <algorithm>
#include <string_view>

#include "stages/encode/glb_file.h"
#include "stages/encode/glb_format.h"
#include "stages/encode/glb_pairs.h"

namespace voxweld {
namespace {

using namespace glb;

int component_of(FeatureIdType type) {
  return type == FeatureIdType::u8    ? component_uint8
         : type == FeatureIdType::u16 ? component_uint16
                                      : component_float;
}

void add_draco(GlbFile& file, const EncodedMesh& mesh, std::span<const MaterialPair> pairs) {
  Json ids;
  const auto add = [&](const char* attribute, int id, int component, const char* type) -> Json& {
    ids[attribute] = id;
    return file.add_attribute(attribute, component, mesh.points, type);
  };
  Json& position = add("POSITION", mesh.position_id, component_float, "VEC3");
  position["min"] = mesh.lo;
  position["max"] = mesh.hi;
  if (mesh.normal_id >= 0) add("NORMAL", mesh.normal_id, component_float, "VEC3");
  if (!pairs.empty()) {
    add("COLOR_0", mesh.colour_id, component_uint8, "VEC4")["normalized"] = true;
    add(feature_attribute, mesh.pair_id, component_of(feature_id_type(pairs.size())), "SCALAR");
  }
  file.add_corners(3 * mesh.triangles);
  file.require(draco_extension);
  const std::size_t view = file.add_view(std::span(mesh.bytes));
  file.primitive()["extensions"][draco_extension] = {{"bufferView", view}, {"attributes", ids}};
  if (!pairs.empty()) file.add_table(pairs);
}

void add_plain(GlbFile& file, const DecodedMesh& mesh) {
  const std::size_t points = mesh.positions.size();
  const auto add = [&](const char* attribute, auto values, int component,
                       const char* type) -> Json& {
    const std::size_t view = file.add_view(values, target_vertices);
    Json& added = file.add_attribute(attribute, component, points, type);
    added["bufferView"] = view;
    return added;
  };
  const auto [lo, hi] = bounds_of(mesh.positions);
  Json& position = add("POSITION", std::span(mesh.positions), component_float, "VEC3");
  position["min"] = lo;
  position["max"] = hi;
  if (!mesh.normals.empty()) add("NORMAL", std::span(mesh.normals), component_float, "VEC3");
  if (!mesh.pairs.empty()) {
    // Ids are floats: what is less than 32 bits would have to be padded to that.
    PointFeatures features = point_features(mesh, file.parameters().materials);
    add("COLOR_0", file.keep(std::move(features.colours)), component_uint8, "VEC4")["normalized"] =
        true;
    add(feature_attribute, file.keep(std::move(features.ids)), component_float, "SCALAR");
  }
  const std::size_t view = file.add_view(std::span(mesh.triangles), target_indices);
  file.add_corners(3 * mesh.triangles.size())["bufferView"] = view;
  if (!mesh.pairs.empty()) file.add_table(mesh.pairs);
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

std::vector<std::byte> wrap_glb(const EncodedMesh& mesh, const GlbParameters& parameters,
                                std::span<const MaterialPair> pairs) {
  GlbFile file(parameters);
  add_draco(file, mesh, pairs);
  std::vector<std::byte> bytes;
  file.write([&](std::span<const std::byte> piece) {
    bytes.insert(bytes.end(), piece.begin(), piece.end());
  });
  return bytes;
}

void write_plain_glb(const DecodedMesh& mesh, const GlbParameters& parameters,
                     const ByteSink& sink) {
  GlbFile file(parameters);
  add_plain(file, mesh);
  file.write(sink);
}

}  // namespace voxweld
