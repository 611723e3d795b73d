#include "pipeline/config/edits.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "pipeline/config/degrees.h"

namespace voxweld {
namespace {

using Axes = std::array<Vec3, 3>;

// Divided by the largest coordinate first, so that no square overflows or vanishes.
Vec3 unit(Vec3 v) {
  const double largest = std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
  v = {v.x / largest, v.y / largest, v.z / largest};
  const double length = std::sqrt(dot(v, v));
  return {v.x / length, v.y / length, v.z / length};
}

// The solid's z is along `axis`. Its x and y are any two that go with it: the shapes that have an
// axis are the same all around it.
Axes axes_along(Vec3 axis) {
  const Vec3 z = unit(axis);
  int least = 0;
  for (int i = 1; i < 3; ++i)
    if (std::abs(z[i]) < std::abs(z[least])) least = i;
  Vec3 other;
  other[least] = 1;
  const Vec3 y = unit(cross(z, other));
  return {cross(y, z), y, z};
}

// v turned about one axis of the frame, right-handed: x towards y about z.
Vec3 turned(Vec3 v, int about, SineCosine angle) {
  const int from = (about + 1) % 3, to = (about + 2) % 3;
  Vec3 out = v;
  out[from] = angle.cosine * v[from] - angle.sine * v[to];
  out[to] = angle.sine * v[from] + angle.cosine * v[to];
  return out;
}

// The solid's axes in the frame are those of the frame turned with the solid.
Axes axes_turned(Vec3 degrees) {
  Axes axes = {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};
  for (int about = 0; about < 3; ++about) {
    const SineCosine angle = sine_cosine_of_degrees(degrees[about]);
    for (Vec3& axis : axes) axis = turned(axis, about, angle);
  }
  return axes;
}

Edit edit_of(const EditConfig& config) {
  Edit edit;
  edit.op = config.op;
  if (gives_material(config.op)) edit.material = config.material.value_or(exterior);
  Solid& solid = edit.solid;
  solid.shape = config.shape;
  solid.center = config.center;
  solid.size = config.size;
  solid.radius = config.radius;
  solid.height = config.height;
  solid.tube = config.tube;
  solid.scale = config.scale;
  const bool turns = config.shape == SolidShape::box || config.shape == SolidShape::mesh;
  solid.axes = turns ? axes_turned(config.rotate) : axes_along(config.axis);
  // Keys of artifacts hash the bits: 0 is written one way.
  for (Vec3& axis : solid.axes) axis = axis + Vec3{};
  return edit;
}

}  // namespace

Edits edits_of(const Config& config) {
  Edits edits;
  edits.reserve(config.edits.size());
  for (const EditConfig& edit : config.edits) edits.push_back(edit_of(edit));
  return edits;
}

}  // namespace voxweld
