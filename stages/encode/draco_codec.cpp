#include "stages/encode/draco_codec.h"

#include <draco/compression/decode.h>
#include <draco/compression/expert_encode.h>
#include <draco/mesh/mesh.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "stages/encode/draco_mesh.h"
#include "storage/support/error.h"

namespace voxweld {
namespace {

using Triangle = std::array<std::uint32_t, 3>;
// Draco numbers corners with a signed 32-bit integer.
constexpr std::uint64_t max_triangles = std::numeric_limits<std::int32_t>::max() / 3;

[[noreturn]] void refuse(const std::string& what) {
  throw InputError("cannot encode the mesh: " + what);
}

void check_lattice(const OutputLattice& lattice) {
  int exponent = 0;
  if (lattice.bits < 1 || lattice.bits > max_lattice_bits)
    refuse(fmt::format("its lattice has {} bits, 1 to {} decode exactly; raise output.precision",
                       lattice.bits, max_lattice_bits));
  if (!(lattice.step > 0) || std::frexp(lattice.step, &exponent) != 0.5)
    refuse(fmt::format("its lattice step is {}, expected a power of two", lattice.step));
  for (const double origin : lattice.origin) {
    if (!(std::fmod(origin, lattice.step) == 0))
      refuse(
          fmt::format("its lattice origin {} is no multiple of the step {}", origin, lattice.step));
  }
  if (!lattice.fits_floats())
    refuse(
        fmt::format("its lattice of step {} and origin {}, {}, {} has coordinates that are no "
                    "floats",
                    lattice.step, lattice.origin[0], lattice.origin[1], lattice.origin[2]));
}

void check_triangles(const TileMesh& mesh) {
  const std::size_t count = mesh.positions.size();
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const Triangle& t = mesh.triangles[i];
    if (std::max({t[0], t[1], t[2]}) >= count)
      refuse(fmt::format("triangle {} refers to vertex {} of {}", i, std::max({t[0], t[1], t[2]}),
                         count));
    if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0])
      refuse(fmt::format("triangle {} has two equal corners ({}, {}, {})", i, t[0], t[1], t[2]));
  }
}

void check_pairs(const TileMesh& mesh) {
  if (mesh.pairs.empty() && mesh.triangle_pairs.empty()) return;
  if (mesh.triangle_pairs.size() != mesh.triangles.size())
    refuse(fmt::format("{} of {} triangles say which labels they separate",
                       mesh.triangle_pairs.size(), mesh.triangles.size()));
  for (const std::uint32_t pair : mesh.triangle_pairs)
    if (pair >= mesh.pairs.size())
      refuse(fmt::format("a triangle names pair {} of {}", pair, mesh.pairs.size()));
}

void check_mesh(const TileMesh& mesh, const EncodeParameters& parameters) {
  check_lattice(mesh.lattice);
  if (mesh.triangles.empty()) refuse("it has no triangles, and neither format can hold none");
  if (mesh.triangles.size() > max_triangles)
    refuse(fmt::format("{} triangles, Draco takes at most {}; write tiles instead of one mesh",
                       mesh.triangles.size(), max_triangles));
  const std::int32_t end = std::int32_t{1} << mesh.lattice.bits;
  for (const auto& q : mesh.positions) {
    if (std::min({q[0], q[1], q[2]}) < 0 || std::max({q[0], q[1], q[2]}) >= end)
      refuse(fmt::format("vertex ({}, {}, {}) lies outside its lattice [0, {})", q[0], q[1], q[2],
                         end));
  }
  check_triangles(mesh);
  check_pairs(mesh);
  if (!parameters.normals) return;
  if (parameters.normal_bits < 2 || parameters.normal_bits > 30)
    refuse(fmt::format("normals of {} bits, expected 2 to 30", parameters.normal_bits));
  if (mesh.normals.size() != mesh.positions.size() ||
      mesh.corner_normals.size() != mesh.triangles.size())
    refuse(
        fmt::format("normals are asked for, but {} of {} vertices and {} of {} triangles have "
                    "them",
                    mesh.normals.size(), mesh.positions.size(), mesh.corner_normals.size(),
                    mesh.triangles.size()));
  for (const auto& corners : mesh.corner_normals) {
    for (const CornerNormal normal : corners)
      if (!normal.valid())
        refuse(fmt::format("a corner takes its normal from {:#x}, expected one of {} directions",
                           normal.bits, max_clusters));
  }
}

// Of the vertices in use: the others are not in the decoded mesh.
void set_bounds(EncodedMesh& out, const TileMesh& mesh) {
  std::array<std::int32_t, 3> lo = mesh.positions[mesh.triangles[0][0]], hi = lo;
  for (const Triangle& t : mesh.triangles) {
    for (const std::uint32_t v : t) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        lo[axis] = std::min(lo[axis], mesh.positions[v][axis]);
        hi[axis] = std::max(hi[axis], mesh.positions[v][axis]);
      }
    }
  }
  out.lo = float_position(mesh.lattice, lo);
  out.hi = float_position(mesh.lattice, hi);
}

// Text that reads back as exactly value: a multiple of step, itself a power of two. Without a
// decimal point, which would depend on the locale.
std::string exact_text(double value, double step) {
  int exponent = 0;
  std::frexp(step, &exponent);
  const auto multiple = static_cast<std::int64_t>(value / step);
  return fmt::format("{}0x{:x}p{}", multiple < 0 ? "-" : "", std::abs(multiple), exponent - 1);
}

// What SetAttributeExplicitQuantization does, but for one thing: Draco keeps its options as text,
// and that call writes them with six decimals, so that a range of 63.9990234375 arrives as
// 63.999023 and every vertex is off the lattice.
draco::Options lattice_quantization(const OutputLattice& lattice) {
  draco::Options options;
  options.SetInt("quantization_bits", lattice.bits);
  options.SetString("quantization_range", exact_text(lattice.range(), lattice.step));
  std::string origin;
  for (const double o : lattice.origin) origin += exact_text(o, lattice.step) + " ";
  options.SetString("quantization_origin", origin);
  return options;
}

// So that whole numbers stay what they are: a step of 1.
draco::Options whole_numbers() {
  draco::Options options;
  options.SetInt("quantization_bits", feature_id_bits);
  options.SetString("quantization_range",
                    exact_text(static_cast<double>((1 << feature_id_bits) - 1), 1));
  options.SetString("quantization_origin", "0");
  return options;
}

void set_options(draco::ExpertEncoder& encoder, const OutputLattice& lattice,
                 const DracoAttributes& ids, const EncodeParameters& parameters,
                 bool pairs_are_floats) {
  if (pairs_are_floats) encoder.options().SetAttributeOptions(ids.pair, whole_numbers());
  encoder.SetSpeedOptions(parameters.encode_speed, parameters.decode_speed);
  encoder.options().SetAttributeOptions(ids.position, lattice_quantization(lattice));
  if (ids.normal >= 0) encoder.SetAttributeQuantization(ids.normal, parameters.normal_bits);
  // Said in any case: else it goes by the speed.
  encoder.options().SetGlobalBool("split_mesh_on_seams", ids.one_normal_each);
  encoder.SetTrackEncodedProperties(true);
}

const draco::PointAttribute* float3_attribute(const draco::Mesh& mesh,
                                              draco::GeometryAttribute::Type type) {
  const draco::PointAttribute* attribute = mesh.GetNamedAttribute(type);
  if (attribute == nullptr || attribute->num_components() != 3 ||
      attribute->data_type() != draco::DT_FLOAT32 || attribute->size() == 0)
    return nullptr;
  return attribute;
}

void read_attribute(const draco::PointAttribute& attribute, std::uint32_t points,
                    std::vector<std::array<float, 3>>& out, const std::string& where) {
  out.resize(points);
  for (std::uint32_t i = 0; i < points; ++i) {
    const draco::AttributeValueIndex value = attribute.mapped_index(draco::PointIndex(i));
    if (value.value() >= attribute.size())
      throw FormatError(fmt::format("{}: damaged Draco data: point {} refers to value {} of {}",
                                    where, i, value.value(), attribute.size()));
    attribute.GetValue(value, out[i].data());
  }
}

EncodedMesh encode_with(const TileMesh& mesh, const EncodeParameters& parameters,
                        const std::vector<PairColour>* colours) {
  check_mesh(mesh, parameters);
  draco::Mesh source;
  const DracoAttributes ids = fill_draco_mesh(mesh, parameters.normals, colours, source);

  draco::ExpertEncoder encoder(source);
  set_options(encoder, mesh.lattice, ids, parameters,
              colours != nullptr && feature_id_type(mesh.pairs.size()) == FeatureIdType::f32);
  draco::EncoderBuffer buffer;
  const draco::Status status = encoder.EncodeToBuffer(&buffer);
  if (!status.ok()) refuse("Draco: " + status.error_msg_string());

  EncodedMesh out;
  out.bytes = copy_bytes(buffer);
  out.points = encoder.num_encoded_points();
  out.triangles = encoder.num_encoded_faces();
  const auto unique = [&](int id) {
    return id < 0 ? -1 : static_cast<int>(source.attribute(id)->unique_id());
  };
  out.position_id = unique(ids.position);
  out.normal_id = unique(ids.normal);
  out.pair_id = unique(ids.pair);
  out.colour_id = unique(ids.colour);
  set_bounds(out, mesh);
  return out;
}

DecodedMesh decode_with(std::span<const std::byte> bytes, const PairList* features,
                        const std::string& where) {
  const std::unique_ptr<draco::Mesh> mesh = decode_draco_mesh(bytes, where);
  const auto* position = float3_attribute(*mesh, draco::GeometryAttribute::POSITION);
  if (position == nullptr)
    throw FormatError(where + ": the Draco mesh has no positions of three 32-bit floats");
  DecodedMesh out;
  out.position_id = static_cast<int>(position->unique_id());
  read_attribute(*position, mesh->num_points(), out.positions, where);
  if (const auto* normal = float3_attribute(*mesh, draco::GeometryAttribute::NORMAL)) {
    out.normal_id = static_cast<int>(normal->unique_id());
    read_attribute(*normal, mesh->num_points(), out.normals, where);
  }
  read_pairs(*mesh, features, out, where);
  out.triangles.resize(mesh->num_faces());
  for (std::uint32_t i = 0; i < mesh->num_faces(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t point = mesh->face(draco::FaceIndex(i))[k].value();
      if (point >= mesh->num_points())
        throw FormatError(
            fmt::format("{}: damaged Draco data: triangle {} refers to point {} of "
                        "{}",
                        where, i, point, mesh->num_points()));
      out.triangles[i][k] = point;
    }
  }
  return out;
}

}  // namespace

EncodedMesh encode_draco(const TileMesh& mesh, const EncodeParameters& parameters) {
  return encode_with(mesh, parameters, nullptr);
}

EncodedMesh encode_draco_features(const TileMesh& mesh, const EncodeParameters& parameters,
                                  const std::vector<PairColour>& colours) {
  if (mesh.pairs.size() > std::size_t{1} << feature_id_bits)
    refuse(fmt::format("{} pairs of labels, glTF takes at most {}; write tiles instead of one mesh",
                       mesh.pairs.size(), std::size_t{1} << feature_id_bits));
  return encode_with(mesh, parameters, &colours);
}

DecodedMesh decode_draco(std::span<const std::byte> bytes, const std::string& where) {
  return decode_with(bytes, nullptr, where);
}

DecodedMesh decode_draco_features(std::span<const std::byte> bytes, const PairList& features,
                                  const std::string& where) {
  return decode_with(bytes, &features, where);
}

// From test_encode_memory (Draco 1.5.5, speeds 0 to 10, meshes of 0.1 to 1.0 M triangles, every
// allocation counted). The most seen, bytes a triangle at half a vertex a triangle: 124 without
// normals; with them 168 where a few edges are seams and 294 where each corner has a normal of its
// own.
std::uint64_t encode_memory_bytes(std::uint64_t vertices, std::uint64_t triangles, bool normals,
                                  bool between_labels) {
  // Entropy coding tables, whose size is that of the largest residual.
  constexpr std::uint64_t tables = std::uint64_t{16} << 20;
  // Where many pairs meet; the most seen of a .glb of 0.25 M triangles: 352 with normals, 301 without.
  const std::uint64_t labels = between_labels ? (normals ? 60 : 160) * triangles : 0;
  return tables + labels +
         (normals ? 100 * vertices + 260 * triangles : 50 * vertices + 110 * triangles);
}

}  // namespace voxweld
