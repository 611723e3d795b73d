#include "pipeline/phantom/smooth_fields.h"

#include <cmath>
#include <numbers>

namespace voxweld {
namespace {

// The larger of the two, rounded off over the range r.
double smooth_max(double u, double v, double r) {
  const double h = std::max(r - std::abs(u - v), 0.0);
  return std::max(u, v) + h * h / (4 * r);
}

}  // namespace

Ring::Ring(std::int64_t size)
    : centre((static_cast<double>(size) - 1) / 2),
      ring(0.29 * static_cast<double>(size)),
      tube(0.12 * static_cast<double>(size)),
      rows(multiply(rotation_y(0.5), rotation_x(0.4))) {}

GyroidField::GyroidField(std::int64_t size)
    : ball_(size, 0.45),
      wavenumber_(2 * std::numbers::pi / (static_cast<double>(size) / 10)),
      amplitude_(1 / (1.4 * wavenumber_)),
      blend_(6 * static_cast<double>(size) / 512) {
  for (int axis = 0; axis < 3; ++axis) {
    Table& table = tables_[static_cast<std::size_t>(axis)];
    for (std::int64_t i = 0; i < size; ++i) {
      const Wave w = wave(axis, static_cast<double>(i));
      table.sine.push_back(w.sine);
      table.cosine.push_back(w.cosine);
    }
  }
}

GyroidField::Wave GyroidField::wave(int axis, double coordinate) const {
  constexpr std::array phase = {0.3, 0.7, 1.1};
  const double angle =
      wavenumber_ * (coordinate - ball_.centre) + phase[static_cast<std::size_t>(axis)];
  return {std::sin(angle), std::cos(angle)};
}

double GyroidField::at(Vec3 p) const {
  const Wave x = wave(0, p.x), y = wave(1, p.y), z = wave(2, p.z);
  const double g = amplitude_ * (x.sine * y.cosine + y.sine * z.cosine + z.sine * x.cosine);
  return smooth_max(g, ball_(p), blend_);
}

// The same expressions as at(), in the same order, so that the bits agree.
void GyroidField::fill(const Box3& box, double /*limit*/, double* out) const {
  const double* const x_sine = tables_[0].sine.data();
  const double* const x_cosine = tables_[0].cosine.data();
  const Ball ball = ball_;
  const double amplitude = amplitude_, blend = blend_;
  for (std::int64_t z = box.lo.z; z < box.hi.z; ++z) {
    for (std::int64_t y = box.lo.y; y < box.hi.y; ++y) {
      const auto yi = static_cast<std::size_t>(y), zi = static_cast<std::size_t>(z);
      const double y_cosine = tables_[1].cosine[yi], z_sine = tables_[2].sine[zi];
      const double yz = tables_[1].sine[yi] * tables_[2].cosine[zi];
      const double v = static_cast<double>(y), w = static_cast<double>(z);
      for (std::int64_t x = box.lo.x; x < box.hi.x; ++x) {
        const double g = amplitude * (x_sine[x] * y_cosine + yz + z_sine * x_cosine[x]);
        *out++ = smooth_max(g, ball({static_cast<double>(x), v, w}), blend);
      }
    }
  }
}

double GyroidField::surface_distance(Vec3 p) const {
  const Wave x = wave(0, p.x), y = wave(1, p.y), z = wave(2, p.z);
  const double g = amplitude_ * (x.sine * y.cosine + y.sine * z.cosine + z.sine * x.cosine);
  const Vec3 g_gradient =
      Vec3{x.cosine * y.cosine - z.sine * x.sine, y.cosine * z.cosine - x.sine * y.sine,
           z.cosine * x.cosine - y.sine * z.sine} *
      (amplitude_ * wavenumber_);
  const Vec3 r = p - Vec3{ball_.centre, ball_.centre, ball_.centre};
  const double b = ball_(p);
  const Vec3 b_gradient = length(r) > 0 ? r * (1 / length(r)) : Vec3{};
  // d smax = (1 - w) d max + w d min, w = h / (2 r)
  const double w = std::max(blend_ - std::abs(g - b), 0.0) / (2 * blend_);
  const Vec3 gradient =
      g > b ? g_gradient * (1 - w) + b_gradient * w : b_gradient * (1 - w) + g_gradient * w;
  const double slope = length(gradient);
  const double d = std::abs(smooth_max(g, b, blend_));
  return slope > 0 ? d / slope : d;
}

}  // namespace voxweld
