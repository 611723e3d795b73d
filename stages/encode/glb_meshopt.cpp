// Based on: the extension specifications EXT_meshopt_compression (version 0 of the vertex codec, 1 of that
// of triangles) and KHR_mesh_quantization.
#include "stages/encode/glb_meshopt.h"

#include <fmt/format.h>
#include <meshoptimizer.h>

#include <cmath>
#include <cstring>
#include <optional>

#include "stages/encode/glb_file.h"
#include "stages/encode/glb_pairs.h"
#include "storage/support/error.h"

namespace voxweld {
namespace {

using namespace glb;

constexpr int oct_bits = 10;

// As it decodes: `count` items of `stride` bytes.
struct Compressed {
  std::vector<std::byte> bytes;
  std::size_t count = 0, stride = 0;
  const char* mode = "ATTRIBUTES";
  const char* filter = nullptr;
};

unsigned char* as_chars(std::vector<std::byte>& bytes) {
  return reinterpret_cast<unsigned char*>(bytes.data());
}

Compressed compressed_points(const void* items, std::size_t count, std::size_t stride,
                             const char* filter = nullptr) {
  Compressed out{{}, count, stride, "ATTRIBUTES", filter};
  out.bytes.resize(meshopt_encodeVertexBufferBound(count, stride));
  out.bytes.resize(
      meshopt_encodeVertexBuffer(as_chars(out.bytes), out.bytes.size(), items, count, stride));
  out.bytes.shrink_to_fit();
  return out;
}

Compressed compressed_triangles(const std::vector<std::uint32_t>& corners, std::size_t points) {
  Compressed out{{}, corners.size(), sizeof(std::uint32_t), "TRIANGLES", nullptr};
  out.bytes.resize(meshopt_encodeIndexBufferBound(corners.size(), points));
  out.bytes.resize(meshopt_encodeIndexBuffer(as_chars(out.bytes), out.bytes.size(), corners.data(),
                                             corners.size()));
  out.bytes.shrink_to_fit();
  return out;
}

// A float as 24 bits times a power of two. That is the lattice's step for all: so neighbours differ in
// few bits, and what decodes is what was there. Nothing where 24 bits do not hold the multiples.
std::optional<std::vector<std::uint32_t>> as_multiples(
    const std::vector<std::array<float, 3>>& positions, double step) {
  constexpr double most = 1 << 23;
  int exponent = 0;
  std::frexp(step, &exponent);
  --exponent;
  if (exponent < -100 || exponent > 100) return std::nullopt;
  std::vector<std::uint32_t> out;
  out.reserve(3 * positions.size());
  for (const auto& position : positions)
    for (const float coordinate : position) {
      const double multiple = coordinate / step;
      if (!(multiple >= -most && multiple < most)) return std::nullopt;
      const auto mantissa = static_cast<std::uint32_t>(static_cast<std::int32_t>(multiple));
      out.push_back(static_cast<std::uint32_t>(exponent) << 24 | (mantissa & 0xffffff));
    }
  return out;
}

Compressed compressed_positions(const std::vector<std::array<float, 3>>& positions, double step) {
  constexpr std::size_t stride = sizeof positions[0];
  if (const auto multiples = as_multiples(positions, step))
    return compressed_points(multiples->data(), positions.size(), stride, "EXPONENTIAL");
  return compressed_points(positions.data(), positions.size(), stride);
}

Compressed compressed_normals(const std::vector<std::array<float, 3>>& normals) {
  std::vector<float> four;
  four.reserve(4 * normals.size());
  for (const auto& n : normals) four.insert(four.end(), {n[0], n[1], n[2], 0});
  constexpr std::size_t stride = 4 * sizeof(std::int16_t);
  std::vector<std::byte> filtered(normals.size() * stride);
  meshopt_encodeFilterOct(filtered.data(), normals.size(), stride, oct_bits, four.data());
  return compressed_points(filtered.data(), normals.size(), stride, "OCTAHEDRAL");
}

// The triangles so that points are used again soon, and the points in the order of their use.
class DrawingOrder {
 public:
  DrawingOrder(const std::vector<std::array<std::uint32_t, 3>>& triangles, std::size_t points)
      : corners_(3 * triangles.size()), place_(points) {
    meshopt_optimizeVertexCache(corners_.data(), triangles.data()->data(), corners_.size(), points);
    used_ =
        meshopt_optimizeVertexFetchRemap(place_.data(), corners_.data(), corners_.size(), points);
    meshopt_remapIndexBuffer(corners_.data(), corners_.data(), corners_.size(), place_.data());
  }
  std::size_t points() const { return used_; }
  const std::vector<std::uint32_t>& corners() const { return corners_; }
  // `values` has as many items as there are points, of `size` bytes each.
  template <class T>
  void sort(std::vector<T>& values) const {
    if (values.empty()) return;
    const std::size_t size = values.size() * sizeof(T) / place_.size();
    std::vector<T> sorted(used_ * size / sizeof(T));
    meshopt_remapVertexBuffer(sorted.data(), values.data(), place_.size(), size, place_.data());
    values = std::move(sorted);
  }

 private:
  std::vector<std::uint32_t> corners_, place_;
  std::size_t used_ = 0;
};

// Returns the view's number.
std::size_t add_view(GlbFile& file, Compressed made, int target) {
  Json how = {{"buffer", 0},         {"byteOffset", 0},
              {"byteLength", 0},     {"byteStride", made.stride},
              {"count", made.count}, {"mode", made.mode}};
  if (made.filter != nullptr) how["filter"] = made.filter;
  Json view = {{"buffer", 1}, {"byteOffset", 0}, {"byteLength", 0}};
  if (target == target_vertices) view["byteStride"] = made.stride;
  view["target"] = target;
  view["extensions"][meshopt_extension] = how;
  return file.add_absent_view(file.keep(std::move(made.bytes)), made.count * made.stride,
                              std::move(view));
}

}  // namespace

void write_meshopt_glb(DecodedMesh mesh, const OutputLattice& lattice,
                       const GlbParameters& parameters, const ByteSink& sink) {
  GlbFile file(parameters);
  PointFeatures features;
  if (!mesh.pairs.empty()) features = point_features(mesh, parameters.materials);
  const DrawingOrder order(mesh.triangles, mesh.positions.size());
  mesh.triangles = {};
  order.sort(mesh.positions);
  order.sort(mesh.normals);
  order.sort(features.colours);
  order.sort(features.ids);
  const std::size_t points = order.points();
  const auto add = [&](const char* attribute, Compressed made, int component,
                       const char* type) -> Json& {
    const std::size_t view = add_view(file, std::move(made), target_vertices);
    Json& added = file.add_attribute(attribute, component, points, type);
    added["bufferView"] = view;
    return added;
  };
  const auto [lo, hi] = bounds_of(mesh.positions);
  Json& position =
      add("POSITION", compressed_positions(mesh.positions, lattice.step), component_float, "VEC3");
  position["min"] = lo;
  position["max"] = hi;
  file.require(meshopt_extension);
  if (!mesh.normals.empty()) {
    file.require(quantization_extension);
    add("NORMAL", compressed_normals(mesh.normals), component_int16, "VEC3")["normalized"] = true;
  }
  if (!mesh.pairs.empty()) {
    add("COLOR_0", compressed_points(features.colours.data(), points, sizeof(PairColour)),
        component_uint8, "VEC4")["normalized"] = true;
    add(feature_attribute, compressed_points(features.ids.data(), points, sizeof(float)),
        component_float, "SCALAR");
  }
  const std::size_t view =
      add_view(file, compressed_triangles(order.corners(), points), target_indices);
  file.add_corners(order.corners().size())["bufferView"] = view;
  if (!mesh.pairs.empty()) file.add_table(mesh.pairs);
  file.write(sink);
}

std::vector<std::byte> decode_meshopt_view(const Json& view, std::span<const std::byte> compressed,
                                           const std::string& where) {
  const Json& how = view.at("extensions").at(meshopt_extension);
  const auto count = how.at("count").get<std::uint64_t>();
  const auto stride = how.at("byteStride").get<std::uint64_t>();
  const auto mode = how.at("mode").get<std::string>();
  const auto filter = how.value("filter", std::string("NONE"));
  const bool points = mode == "ATTRIBUTES" && stride > 0 && stride <= 256 && stride % 4 == 0;
  const bool triangles = mode == "TRIANGLES" && stride == 4 && count % 3 == 0 && filter == "NONE";
  const bool filtered = filter == "NONE" || filter == "EXPONENTIAL" ||
                        (filter == "OCTAHEDRAL" && (stride == 4 || stride == 8));
  if (!filtered || (!points && !triangles))
    throw FormatError(fmt::format("{}: glTF view of mode {}, stride {} and filter {}", where, mode,
                                  stride, filter));
  // Two bits say that sixteen bytes are those before; a triangle takes a byte.
  if (count == 0 || count > (compressed.size() + 1024) * 64 / stride ||
      view.at("byteLength").get<std::uint64_t>() != count * stride)
    throw FormatError(fmt::format("{}: glTF view of {} items of {} bytes, compressed to {} bytes",
                                  where, count, stride, compressed.size()));
  std::vector<std::byte> bytes(count * stride);
  const auto* from = reinterpret_cast<const unsigned char*>(compressed.data());
  const int failed =
      triangles ? meshopt_decodeIndexBuffer(bytes.data(), count, stride, from, compressed.size())
                : meshopt_decodeVertexBuffer(bytes.data(), count, stride, from, compressed.size());
  if (failed != 0) throw FormatError(where + ": damaged glTF view: meshoptimizer refuses it");
  if (filter == "EXPONENTIAL") meshopt_decodeFilterExp(bytes.data(), count, stride);
  if (filter == "OCTAHEDRAL") meshopt_decodeFilterOct(bytes.data(), count, stride);
  return bytes;
}

}  // namespace voxweld
