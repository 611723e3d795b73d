#include "pipeline/phantom/csg_model.h"

#include <cmath>

namespace voxweld {
namespace {

using enum CsgPrimitive::Op;

// Distance to the product of an interval of excess a (negative inside) and another of excess b.
double extrude(double a, double b) {
  const double u = std::max(a, 0.0), v = std::max(b, 0.0);
  return std::sqrt(u * u + v * v) + std::min(std::max(a, b), 0.0);
}

double box_distance(Vec3 r, Vec3 half) {
  const double x = std::abs(r.x) - half.x, y = std::abs(r.y) - half.y, z = std::abs(r.z) - half.z;
  const double u = std::max(x, 0.0), v = std::max(y, 0.0), w = std::max(z, 0.0);
  return std::sqrt(u * u + v * v + w * w) + std::min(std::max(std::max(x, y), z), 0.0);
}

double cylinder_distance(double u, double v, double along, double radius, double half_height) {
  return extrude(std::sqrt(u * u + v * v) - radius, std::abs(along) - half_height);
}

// Isosceles triangle with corners (-w, -h), (w, -h), (0, h): exact by its two edges and the foot
// of the point on each.
double triangle_distance(double y, double z, double w, double h) {
  const double u = std::abs(y), v = z + h;  // apex now at (0, 2 h), base on v = 0
  const double base_du = u - std::min(u, w);
  const double base = std::sqrt(base_du * base_du + v * v);
  const double t = std::clamp(((w - u) * w + v * 2 * h) / (w * w + 4 * h * h), 0.0, 1.0);
  const double slope_du = u - w * (1 - t), slope_dv = v - 2 * h * t;
  const double slope = std::sqrt(slope_du * slope_du + slope_dv * slope_dv);
  const bool inside = v > 0 && u * 2 * h + v * w < 2 * h * w;
  const double distance = std::min(base, slope);
  return inside ? -distance : distance;
}

// f(distance), where distance(r) is that of the primitive's shape to r from its centre.
template <class F>
auto with_distance(const CsgPrimitive& p, F&& f) {
  const Vec3 half = p.half;
  switch (p.shape) {
    case CsgShape::box:
      return f([half](Vec3 r) { return box_distance(r, half); });
    case CsgShape::cylinder_x:
      return f([half](Vec3 r) { return cylinder_distance(r.y, r.z, r.x, half.y, half.x); });
    case CsgShape::cylinder_z:
      return f([half](Vec3 r) { return cylinder_distance(r.x, r.y, r.z, half.x, half.z); });
    case CsgShape::gable:
      break;
  }
  return f([half](Vec3 r) {
    return extrude(triangle_distance(r.y, r.z, half.y, half.z), std::abs(r.x) - half.x);
  });
}

}  // namespace

double signed_distance(const CsgPrimitive& p, Vec3 q) {
  return with_distance(p, [&](auto distance) { return distance(q - p.centre); });
}

void signed_distances(const CsgPrimitive& p, const double* x, const double* y, const double* z,
                      std::size_t count, double* out) {
  with_distance(p, [&, centre = p.centre](auto distance) {
    for (std::size_t i = 0; i < count; ++i) out[i] = distance(Vec3{x[i], y[i], z[i]} - centre);
  });
}

CsgModel part_model() {
  CsgModel model{multiply(multiply(rotation_z(0.37), rotation_y(0.61)), rotation_x(0.23)), {}};
  auto& list = model.primitives;
  const CsgPrimitive bore{subtract, CsgShape::cylinder_z, {0, 0, 0}, {38, 38, 300}};
  list.push_back({unite, CsgShape::box, {0, 0, -60}, {150, 110, 24}});
  list.push_back({unite, CsgShape::box, {95, 0, 20}, {18, 90, 70}});
  list.push_back({unite, CsgShape::box, {-95, 0, 20}, {18, 90, 70}});
  list.push_back({unite, CsgShape::cylinder_z, {0, 0, 10}, {62, 62, 75}});
  list.push_back(bore);
  for (const double x : {-125.0, 125.0})
    for (const double y : {-85.0, 85.0})
      list.push_back({subtract, CsgShape::cylinder_z, {x, y, -60}, {13, 13, 60}});
  for (const double y : {40.0, -40.0})
    list.push_back({subtract, CsgShape::cylinder_x, {0, y, 40}, {200, 22, 22}});
  list.push_back({subtract, CsgShape::box, {0, 0, 80}, {12, 200, 18}});
  // The nearest fin is the one rounding finds, so nine boxes give the same values.
  for (int fin = -4; fin <= 4; ++fin)
    list.push_back({unite, CsgShape::box, {-30, 20.0 * fin, -30}, {36, 3, 22}});
  list.push_back(bore);
  return model;
}

CsgModel temple_model() {
  CsgModel model{{Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}, {}};
  auto& list = model.primitives;
  list.push_back({unite, CsgShape::box, {0, 0, -150}, {200, 140, 10}});
  list.push_back({unite, CsgShape::box, {0, 0, -140}, {185, 125, 20}});
  list.push_back({unite, CsgShape::box, {0, 0, -130}, {170, 110, 30}});
  list.push_back({unite, CsgShape::box, {0, 0, -21}, {100, 55, 89}});
  list.push_back({subtract, CsgShape::box, {0, 0, -20}, {92, 47, 70}});
  list.push_back({subtract, CsgShape::box, {100, 0, -45}, {20, 18, 45}});
  const auto column = [&](double x, double y) {
    list.push_back({unite, CsgShape::cylinder_z, {x, y, -22}, {13, 13, 88}});
  };
  for (int i = -4; i <= 4; ++i)
    for (const double y : {-90.0, 90.0}) column(37.5 * i, y);
  for (const double y : {-45.0, 0.0, 45.0})
    for (const double x : {-150.0, 150.0}) column(x, y);
  list.push_back({unite, CsgShape::box, {0, 0, 70}, {166, 106, 10}});
  list.push_back({unite, CsgShape::gable, {0, 0, 111}, {180, 120, 39}});
  return model;
}

}  // namespace voxweld
