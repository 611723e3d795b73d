#include "stages/encode/fragment_codec.h"

#include <draco/compression/expert_encode.h>
#include <draco/mesh/mesh.h>
#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <memory>

#include "stages/encode/draco_mesh.h"
#include "stages/encode/lattice_mesh.h"
#include "storage/support/error.h"

namespace voxweld {
namespace {

// Draco numbers corners with a signed 32-bit integer.
constexpr std::size_t most_triangles = std::numeric_limits<std::int32_t>::max() / 3;
constexpr int fragment_speed = 4;  // as EncodeParameters, and for the same reasons

int add_whole_positions(draco::Mesh& out, const FragmentMesh& mesh) {
  draco::GeometryAttribute attribute;
  attribute.Init(draco::GeometryAttribute::POSITION, nullptr, 3, draco::DT_INT32, false,
                 3 * sizeof(std::int32_t), 0);
  const int id =
      out.AddAttribute(attribute, true, static_cast<std::uint32_t>(mesh.positions.size()));
  for (std::uint32_t v = 0; v < mesh.positions.size(); ++v)
    out.attribute(id)->SetAttributeValue(draco::AttributeValueIndex(v), mesh.positions[v].data());
  return id;
}

}  // namespace

FragmentMesh weld_fragment(std::span<const FragmentTriangle> triangles) {
  PointIndex index;
  index.reserve(triangles.size() / 2 + 3);
  FragmentMesh mesh;
  mesh.triangles.reserve(triangles.size());
  for (const FragmentTriangle& corners : triangles) {
    auto& triangle = mesh.triangles.emplace_back();
    for (std::size_t i = 0; i < 3; ++i)
      triangle[i] = index.add({corners[i][0], corners[i][1], corners[i][2]});
  }
  mesh.positions = index.take();
  return mesh;
}

std::vector<std::byte> encode_fragment(const FragmentMesh& mesh) {
  if (mesh.triangles.size() > most_triangles)
    throw InputError(fmt::format(
        "a fragment of {} triangles, Draco takes at most {}; make the mesh coarser with "
        "simplify.tolerance",
        mesh.triangles.size(), most_triangles));
  draco::Mesh source;
  source.set_num_points(static_cast<std::uint32_t>(mesh.positions.size()));
  add_whole_positions(source, mesh);
  source.SetNumFaces(mesh.triangles.size());
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    const auto& t = mesh.triangles[i];
    source.SetFace(draco::FaceIndex(i),
                   {draco::PointIndex(t[0]), draco::PointIndex(t[1]), draco::PointIndex(t[2])});
  }
  draco::ExpertEncoder encoder(source);
  encoder.SetSpeedOptions(fragment_speed, fragment_speed);
  encoder.SetEncodingMethod(draco::MESH_EDGEBREAKER_ENCODING);
  draco::EncoderBuffer buffer;
  const draco::Status status = encoder.EncodeToBuffer(&buffer);
  if (!status.ok())
    throw InputError("cannot encode a fragment: Draco: " + status.error_msg_string());
  return copy_bytes(buffer);
}

FragmentMesh decode_fragment(std::span<const std::byte> bytes, const std::string& where) {
  const std::unique_ptr<draco::Mesh> source = decode_draco_mesh(bytes, where);
  const auto* position = source->GetNamedAttribute(draco::GeometryAttribute::POSITION);
  if (position == nullptr || position->num_components() != 3 ||
      position->data_type() != draco::DT_INT32)
    throw FormatError(where + ": the Draco mesh has no positions of three 32-bit integers");
  // Clients read values as if each were a point.
  if (position->size() != source->num_points())
    throw FormatError(fmt::format("{}: the Draco mesh has {} positions for {} points", where,
                                  position->size(), source->num_points()));
  FragmentMesh mesh;
  mesh.positions.resize(position->size());
  for (std::uint32_t i = 0; i < position->size(); ++i) {
    auto& q = mesh.positions[i];
    position->GetValue(draco::AttributeValueIndex(i), q.data());
    if (std::min({q[0], q[1], q[2]}) < 0 || std::max({q[0], q[1], q[2]}) > fragment_range)
      throw FormatError(fmt::format("{}: position {}, {}, {} is not in 0 .. {}", where, q[0], q[1],
                                    q[2], fragment_range));
  }
  mesh.triangles.resize(source->num_faces());
  for (std::uint32_t i = 0; i < source->num_faces(); ++i)
    for (std::size_t k = 0; k < 3; ++k) {
      const draco::PointIndex point = source->face(draco::FaceIndex(i))[k];
      const std::uint32_t value = point.value() < source->num_points()
                                      ? position->mapped_index(point).value()
                                      : std::numeric_limits<std::uint32_t>::max();
      if (value >= mesh.positions.size())
        throw FormatError(
            fmt::format("{}: damaged Draco data: triangle {} names a point that is not "
                        "there",
                        where, i));
      mesh.triangles[i][k] = value;
    }
  return mesh;
}

}  // namespace voxweld
