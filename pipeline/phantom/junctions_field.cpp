#include "pipeline/phantom/junctions_field.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace voxweld {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

Vec3 unit(Vec3 v) {
  return v * (1 / length(v));
}

}  // namespace

JunctionsField::JunctionsField(std::int64_t size)
    : centre_((static_cast<double>(size) - 1) / 2), radius_(0.2 * static_cast<double>(size)) {
  const Vec3 c{centre_, centre_, centre_}, aside{0.25 * static_cast<double>(size), 0, 0};
  balls_ = {wedges(c - aside), foam(c + aside)};
}

JunctionsField::Ball JunctionsField::wedges(Vec3 centre) {
  const Rows turn = multiply(rotation_z(0.37), multiply(rotation_y(0.61), rotation_x(0.23)));
  Ball ball{centre, {}, 1, {}, {}, false};
  for (int k = 0; k < 3; ++k) {
    const double a = 2 * std::numbers::pi * k / 3;
    ball.directions.push_back(apply_transposed(turn, {std::cos(a), std::sin(a), 0}));
  }
  const Vec3 axis = apply_transposed(turn, {0, 0, 1});
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t k = i + 1; k < 3; ++k)
      ball.sectors.push_back({i + 1, k + 1, unit(ball.directions[i] + ball.directions[k]), axis,
                              std::numbers::pi / 2});
  ball.borders = {axis, axis * -1};
  return ball;
}

JunctionsField::Ball JunctionsField::foam(Vec3 centre) {
  const Rows turn = multiply(rotation_z(0.5), multiply(rotation_y(0.4), rotation_x(0.9)));
  Ball ball{centre, {}, 4, {}, {}, true};
  for (const Vec3& u : {Vec3{1, 1, 1}, Vec3{1, -1, -1}, Vec3{-1, 1, -1}, Vec3{-1, -1, 1}})
    ball.directions.push_back(apply_transposed(turn, u));
  for (const Vec3& w : ball.directions) ball.borders.push_back(unit(w) * -1);
  // Between i and k, from the radius against the third direction to that against the fourth: their
  // sum is against that of i and k, since the four add up to nothing.
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t k = i + 1; k < 4; ++k) {
      Vec3 others[2];
      for (std::size_t m = 0, n = 0; m < 4; ++m)
        if (m != i && m != k) others[n++] = ball.borders[m];
      const Vec3 middle = unit(others[0] + others[1]);
      ball.sectors.push_back(
          {4 + i, 4 + k, middle, unit(others[0] - others[1]), std::acos(dot(middle, others[0]))});
    }
  return ball;
}

std::uint64_t JunctionsField::cone_of(const Ball& ball, Vec3 q) const {
  std::size_t best = 0;
  for (std::size_t k = 1; k < ball.directions.size(); ++k)
    if (dot(ball.directions[k], q) > dot(ball.directions[best], q)) best = k;
  return ball.first_label + best;
}

std::uint64_t JunctionsField::label_at(Vec3 p) const {
  const Ball& ball = ball_of(p);
  const Vec3 q = p - ball.centre;
  return length(q) > radius_ ? 0 : cone_of(ball, q);
}

void JunctionsField::fill(const Box3& box, double /*limit*/, double* out) const {
  fill_by_point(box, out, [this](Vec3 p) { return static_cast<double>(label_at(p)); });
}

double JunctionsField::volume(std::uint64_t label) const {
  const double ball = 4 * std::numbers::pi / 3 * radius_ * radius_ * radius_;
  return ball / static_cast<double>(ball_with(label).directions.size());
}

JunctionsField::InPlane JunctionsField::in_plane(const Sector& sector, Vec3 q) {
  return {dot(q, sector.middle), std::abs(dot(q, sector.side)),
          dot(q, cross(sector.middle, sector.side))};
}

double JunctionsField::disk_distance(const Sector& sector, Vec3 q) const {
  const auto [along, across, above] = in_plane(sector, q);
  if (std::atan2(across, along) <= sector.angle)
    return std::hypot(std::max(std::hypot(along, across) - radius_, 0.0), above);
  const double c = std::cos(sector.angle), s = std::sin(sector.angle);
  const double on_edge = std::clamp(along * c + across * s, 0.0, radius_);
  return std::hypot(along - on_edge * c, across - on_edge * s, above);
}

double JunctionsField::arc_distance(const Sector& sector, Vec3 q) const {
  const auto [along, across, above] = in_plane(sector, q);
  const double angle = std::min(std::atan2(across, along), sector.angle);
  return std::hypot(along - radius_ * std::cos(angle), across - radius_ * std::sin(angle), above);
}

// A convex piece of the sphere: its nearest point is straight above or below q, or on its border.
double JunctionsField::sphere_distance(const Ball& ball, std::uint64_t label, Vec3 q) const {
  if (cone_of(ball, q) == label) return std::abs(length(q) - radius_);
  double nearest = infinity;
  for (const Sector& sector : ball.sectors)
    if (sector.a == label || sector.b == label)
      nearest = std::min(nearest, arc_distance(sector, q));
  return nearest;
}

double JunctionsField::interface_distance(Vec3 p, std::uint64_t a, std::uint64_t b) const {
  const auto [low, high] = std::minmax(a, b);
  if (low == high || high > labels) return infinity;
  const Ball& ball = ball_with(high);
  const Vec3 q = p - ball.centre;
  if (low == 0) return sphere_distance(ball, high, q);
  for (const Sector& sector : ball.sectors)
    if (sector.a == low && sector.b == high) return disk_distance(sector, q);
  return infinity;
}

double JunctionsField::surface_distance(Vec3 p) const {
  double nearest = infinity;
  for (const Ball& ball : balls_) {
    const Vec3 q = p - ball.centre;
    nearest = std::min(nearest, std::abs(length(q) - radius_));
    for (const Sector& sector : ball.sectors) nearest = std::min(nearest, disk_distance(sector, q));
  }
  return nearest;
}

double JunctionsField::curve_distance(Vec3 p) const {
  double nearest = infinity;
  for (const Ball& ball : balls_) {
    const Vec3 q = p - ball.centre;
    for (const Vec3& border : ball.borders) {
      const double on_radius = std::clamp(dot(q, border), 0.0, radius_);
      nearest = std::min(nearest, length(q - border * on_radius));
    }
    for (const Sector& sector : ball.sectors) nearest = std::min(nearest, arc_distance(sector, q));
  }
  return nearest;
}

double JunctionsField::corner_distance(Vec3 p) const {
  double nearest = infinity;
  for (const Ball& ball : balls_) {
    const Vec3 q = p - ball.centre;
    if (ball.meet_in_centre) nearest = std::min(nearest, length(q));
    for (const Vec3& border : ball.borders)
      nearest = std::min(nearest, length(q - border * radius_));
  }
  return nearest;
}

}  // namespace voxweld
