#include "stages/encode/corner_points.h"

namespace voxweld {
namespace {

std::array<float, 3> float_normal(const TileMesh& mesh, std::uint32_t vertex, CornerNormal normal) {
  const Vec3 n = normal.of(mesh.normals[vertex]);
  return {static_cast<float>(n.x), static_cast<float>(n.y), static_cast<float>(n.z)};
}

DecodedMesh pair_points(const TileMesh& mesh, bool normals) {
  const PairPoints points(mesh, normals);
  DecodedMesh out;
  out.positions.reserve(points.points().size());
  if (normals) out.normals.reserve(points.points().size());
  for (const PairPoints::Point& point : points.points()) {
    out.positions.push_back(float_position(mesh.lattice, mesh.positions[point.vertex]));
    if (normals) out.normals.push_back(float_normal(mesh, point.vertex, point.normal));
  }
  out.triangles = points.corners();
  out.pairs = mesh.pairs;
  out.triangle_pairs = mesh.triangle_pairs;
  return out;
}

}  // namespace

PairPoints::PairPoints(const TileMesh& mesh, bool normals)
    : first_(mesh.positions.size(), no_point), corners_(mesh.triangles.size()) {
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k)
      corners_[i][k] = number_of({mesh.triangles[i][k], mesh.triangle_pairs[i],
                                  normals ? mesh.corner_normals[i][k] : CornerNormal{}});
  first_ = {};
  next_ = {};
}

std::uint32_t PairPoints::number_of(const Point& point) {
  std::uint32_t* at = &first_[point.vertex];
  while (*at != no_point && points_[*at] != point) at = &next_[*at];
  if (*at != no_point) return *at;
  const auto number = static_cast<std::uint32_t>(points_.size());
  *at = number;
  points_.push_back(point);
  next_.push_back(no_point);
  return number;
}

DecodedMesh corner_points(const TileMesh& mesh, bool normals) {
  if (!mesh.pairs.empty()) return pair_points(mesh, normals && !mesh.corner_normals.empty());
  DecodedMesh out;
  if (!normals || mesh.corner_normals.empty()) {
    out.positions.reserve(mesh.positions.size());
    for (const LatticePoint& q : mesh.positions)
      out.positions.push_back(float_position(mesh.lattice, q));
    out.triangles = mesh.triangles;
    return out;
  }
  const CornerPoints points(mesh);
  out.positions.resize(points.count());
  out.normals.resize(points.count());
  points.each([&](std::uint32_t point, std::uint32_t vertex, CornerNormal normal) {
    out.positions[point] = float_position(mesh.lattice, mesh.positions[vertex]);
    out.normals[point] = float_normal(mesh, vertex, normal);
  });
  out.triangles.reserve(mesh.triangles.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    auto& corners = out.triangles.emplace_back();
    for (std::size_t k = 0; k < 3; ++k)
      corners[k] = points.of(mesh.triangles[t][k], mesh.corner_normals[t][k]);
  }
  return out;
}

}  // namespace voxweld
