// Closed triangle meshes for tests.
#pragma once

#include <cmath>
#include <map>
#include <numbers>
#include <random>

#include "storage/types/triangle_mesh.h"

namespace voxweld::testing {

inline TriangleMesh tetrahedron(const std::array<Vec3, 4>& corners) {
  return {{corners.begin(), corners.end()}, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}};
}

inline TriangleMesh box_mesh(Vec3 lo, Vec3 hi) {
  TriangleMesh mesh;
  for (int i = 0; i < 8; ++i)
    mesh.vertices.push_back(
        {(i & 1) != 0 ? hi.x : lo.x, (i & 2) != 0 ? hi.y : lo.y, (i & 4) != 0 ? hi.z : lo.z});
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

// Both, with the vertices of the second behind those of the first.
inline TriangleMesh joined(TriangleMesh mesh, const TriangleMesh& other) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), other.vertices.begin(), other.vertices.end());
  for (const auto& t : other.triangles)
    mesh.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  return mesh;
}

// Every triangle to four, through the middles of its edges.
inline TriangleMesh subdivided(const TriangleMesh& coarse) {
  TriangleMesh mesh{coarse.vertices, {}};
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
  const auto middle = [&](std::uint32_t a, std::uint32_t b) {
    const auto [found, added] = middles.try_emplace(
        {std::min(a, b), std::max(a, b)}, static_cast<std::uint32_t>(mesh.vertices.size()));
    if (added) mesh.vertices.push_back((mesh.vertices[a] + mesh.vertices[b]) * 0.5);
    return found->second;
  };
  for (const auto& [a, b, c] : coarse.triangles) {
    const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
    for (const auto& t : {std::array{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}})
      mesh.triangles.push_back(t);
  }
  return mesh;
}

// A ball with dents, through `levels` subdivisions of a tetrahedron.
inline TriangleMesh dented_ball(Vec3 center, double radius, int levels) {
  TriangleMesh mesh = tetrahedron({Vec3{1, 1, 1}, {-1, 1, -1}, {1, -1, -1}, {-1, -1, 1}});
  for (int i = 0; i < levels; ++i) mesh = subdivided(mesh);
  for (Vec3& v : mesh.vertices) {
    const Vec3 n = v * (1 / std::sqrt(dot(v, v)));
    v = center + n * (radius * (1 + 0.3 * std::sin(5 * n.x) * std::cos(4 * n.y + n.z)));
  }
  return mesh;
}

// About the origin by three random angles.
inline void turn(TriangleMesh& mesh, std::mt19937& random) {
  std::uniform_real_distribution<double> angle(0, 6.283);
  for (int about = 0; about < 3; ++about) {
    const double a = angle(random);
    for (Vec3& v : mesh.vertices) {
      const double p = v[(about + 1) % 3], q = v[(about + 2) % 3];
      v[(about + 1) % 3] = std::cos(a) * p - std::sin(a) * q;
      v[(about + 2) % 3] = std::sin(a) * p + std::cos(a) * q;
    }
  }
}

inline double volume_of(const TriangleMesh& mesh) {
  double sum = 0;
  for (const auto& t : mesh.triangles)
    sum += dot(mesh.vertices[t[0]], cross(mesh.vertices[t[1]], mesh.vertices[t[2]]));
  return sum / 6;
}

// How often the mesh winds around p (van Oosterom, Strackee, "The Solid Angle of a Plane Triangle",
// IEEE Trans. Biomed. Eng. 30(2), 1983).
inline double winding(const TriangleMesh& mesh, Vec3 p) {
  double sum = 0;
  for (const auto& t : mesh.triangles) {
    const Vec3 a = mesh.vertices[t[0]] - p, b = mesh.vertices[t[1]] - p,
               c = mesh.vertices[t[2]] - p;
    const double la = std::sqrt(dot(a, a)), lb = std::sqrt(dot(b, b)), lc = std::sqrt(dot(c, c));
    sum += std::atan2(dot(a, cross(b, c)),
                      la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
  }
  return sum / (2 * std::numbers::pi);
}

// Of the point to the triangle (Ericson, "Real-Time Collision Detection", 2005, 5.1.5), squared.
inline double square_distance(Vec3 p, Vec3 a, Vec3 b, Vec3 c) {
  const auto square = [](Vec3 v) { return dot(v, v); };
  const auto to_segment = [&](Vec3 from, Vec3 to) {
    const Vec3 d = to - from;
    const double length = square(d);
    const double t = length > 0 ? std::clamp(dot(p - from, d) / length, 0.0, 1.0) : 0;
    return square(p - from - d * t);
  };
  const Vec3 n = cross(b - a, c - a);
  if (square(n) > 0 && dot(cross(b - a, n), p - a) <= 0 && dot(cross(c - b, n), p - b) <= 0 &&
      dot(cross(a - c, n), p - c) <= 0) {
    const double above = dot(p - a, n);
    return above * above / square(n);
  }
  return std::min({to_segment(a, b), to_segment(b, c), to_segment(c, a)});
}
inline double distance(Vec3 p, Vec3 a, Vec3 b, Vec3 c) {
  return std::sqrt(square_distance(p, a, b, c));
}

}  // namespace voxweld::testing
