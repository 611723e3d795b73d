// How far a mesh lies from a surface to which distances are known.
#pragma once

#include <array>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <span>

#include "storage/types/box.h"
#include "tests/support/distance_statistics.h"

namespace voxweld {

using TriangleCorners = std::array<std::uint32_t, 3>;

struct MeshDistances {
  DistanceStatistics vertices;
  // Ten points a triangle, evenly spread inside it (barycentric (i + 1/3, j + 1/3, k + 1/3) / 4
  // with i + j + k = 3), every triangle counting the same.
  DistanceStatistics triangles;
  DistanceStatistics by_area;  // of the same points, each as much as its triangle is large
};

inline constexpr std::size_t points_a_triangle = 10;

inline std::array<Vec3, points_a_triangle> barycentric_points() {
  std::array<Vec3, points_a_triangle> points;
  std::size_t n = 0;
  for (int i = 0; i <= 3; ++i)
    for (int j = 0; i + j <= 3; ++j)
      points[n++] = Vec3{i + 1.0 / 3, j + 1.0 / 3, 3 - i - j + 1.0 / 3} * 0.25;
  return points;
}

inline double area_of(Vec3 a, Vec3 b, Vec3 c) {
  const Vec3 n = cross(b - a, c - a);
  return std::sqrt(dot(n, n)) / 2;
}

// Of the points themselves. distance_to(p): from p to the surface; called from many threads.
template <class F>
DistanceStatistics measure_points(const F& distance_to, std::span<const Vec3> points) {
  return distance_statistics<1>(points.size(),
                                [&](std::size_t i, std::array<double, 1>& out) {
                                  out[0] = distance_to(points[i]);
                                  return 1.0;
                                })
      .plain;
}

// Precondition: triangles index vertices. Runs on the current TBB arena.
template <class F>
MeshDistances measure_mesh(const F& distance_to, std::span<const Vec3> vertices,
                           std::span<const TriangleCorners> triangles) {
  const auto points = barycentric_points();
  const WeighedStatistics inside = distance_statistics<points_a_triangle>(
      triangles.size(), [&](std::size_t i, std::array<double, points_a_triangle>& out) {
        const TriangleCorners& t = triangles[i];
        assert(t[0] < vertices.size() && t[1] < vertices.size() && t[2] < vertices.size());
        const Vec3 a = vertices[t[0]], b = vertices[t[1]], c = vertices[t[2]];
        for (std::size_t k = 0; k < points_a_triangle; ++k)
          out[k] = distance_to(a * points[k].x + b * points[k].y + c * points[k].z);
        return area_of(a, b, c);
      });
  return {measure_points(distance_to, vertices), inside.plain, inside.by_weight};
}

}  // namespace voxweld
