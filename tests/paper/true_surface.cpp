#include "tests/paper/true_surface.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <vector>

namespace voxweld::paper {
namespace {

double length(Vec3 v) {
  return std::sqrt(dot(v, v));
}

Vec3 local(const Solid& solid, Vec3 p) {
  const Vec3 d = p - solid.center;
  return {dot(solid.axes[0], d), dot(solid.axes[1], d), dot(solid.axes[2], d)};
}
Vec3 global(const Solid& solid, Vec3 v) {
  return solid.axes[0] * v.x + solid.axes[1] * v.y + solid.axes[2] * v.z;
}

// Beyond each pair of faces of a box: negative between them.
Vec3 excess(const Solid& box, Vec3 q) {
  return {std::abs(q.x) - box.size.x / 2, std::abs(q.y) - box.size.y / 2,
          std::abs(q.z) - box.size.z / 2};
}

Vec3 ring_point(const Solid& torus, Vec3 q) {
  const double across = std::max(std::hypot(q.x, q.y), 1e-12);
  return {q.x / across * torus.radius, q.y / across * torus.radius, 0};
}

double degrees_between(Vec3 a, Vec3 b) {
  return std::acos(std::clamp(dot(a, b), -1.0, 1.0)) * 180 / std::numbers::pi;
}

[[noreturn]] void unknown() {
  throw std::logic_error("true_surface: spheres, tori and boxes only");
}

}  // namespace

double distance_to_surface(const Solid& solid, Vec3 p) {
  const Vec3 q = local(solid, p);
  switch (solid.shape) {
    case SolidShape::sphere:
      return std::abs(length(q) - solid.radius);
    case SolidShape::torus:
      return std::abs(length(q - ring_point(solid, q)) - solid.tube);
    case SolidShape::box: {
      const Vec3 e = excess(solid, q);
      const double most = std::max({e.x, e.y, e.z});
      if (most <= 0) return -most;
      return length({std::max(e.x, 0.0), std::max(e.y, 0.0), std::max(e.z, 0.0)});
    }
    default:
      unknown();
  }
}

double volume_of_solid(const Solid& solid) {
  constexpr double pi = std::numbers::pi;
  switch (solid.shape) {
    case SolidShape::sphere:
      return 4.0 / 3 * pi * solid.radius * solid.radius * solid.radius;
    case SolidShape::torus:
      return 2 * pi * pi * solid.radius * solid.tube * solid.tube;
    case SolidShape::box:
      return solid.size.x * solid.size.y * solid.size.z;
    default:
      unknown();
  }
}

double degrees_off(const Solid& solid, Vec3 p, Vec3 unit, double reach) {
  const Vec3 q = local(solid, p);
  if (solid.shape == SolidShape::sphere)
    return degrees_between(unit, global(solid, q * (1 / length(q))));
  if (solid.shape == SolidShape::torus) {
    const Vec3 out = q - ring_point(solid, q);
    return degrees_between(unit, global(solid, out * (1 / length(out))));
  }
  const Vec3 e = excess(solid, q);
  const double most = std::max({e.x, e.y, e.z});
  double least = 180;
  for (int a = 0; a < 3; ++a) {
    if (e[a] < most - reach) continue;
    Vec3 face;
    face[a] = q[a] < 0 ? -1 : 1;
    least = std::min(least, degrees_between(unit, global(solid, face)));
  }
  return least;
}

SurfaceErrors surface_errors(const Solid& solid, const TriangleMesh& mesh) {
  SurfaceErrors errors;
  errors.triangles = mesh.triangles.size();
  double area = 0, volume = 0;
  std::vector<std::pair<double, double>> angles;  // with their areas
  for (const auto& t : mesh.triangles) {
    const Vec3 a = mesh.vertices[t[0]], b = mesh.vertices[t[1]], c = mesh.vertices[t[2]];
    volume += dot(a, cross(b, c)) / 6;
    const Vec3 normal = cross(b - a, c - a);
    const double twice = length(normal);
    if (!(twice > 0)) continue;
    for (int i = 0; i < 4; ++i)
      for (int j = 0; i + j < 4; ++j) {
        const double u = (i + 1.0 / 3) / 4, v = (j + 1.0 / 3) / 4;
        const Vec3 p = a * (1 - u - v) + b * u + c * v;
        const double d = distance_to_surface(solid, p), weight = twice / 20;
        const double degrees = degrees_off(solid, p, normal * (1 / twice), 0.75);
        area += weight;
        errors.mean += weight * d;
        errors.rms += weight * d * d;
        errors.max = std::max(errors.max, d);
        errors.mean_degrees += weight * degrees;
        angles.emplace_back(degrees, weight);
      }
  }
  errors.mean /= area;
  errors.rms = std::sqrt(errors.rms / area);
  errors.mean_degrees /= area;
  std::sort(angles.begin(), angles.end());
  errors.max_degrees = angles.back().first;
  double rest = 0.01 * area;
  for (auto worst = angles.rbegin(); worst != angles.rend() && rest > 0; ++worst) {
    rest -= worst->second;
    errors.worst_degrees = worst->first;
  }
  errors.volume = volume / volume_of_solid(solid) - 1;
  return errors;
}

}  // namespace voxweld::paper
