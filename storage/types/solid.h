// Solids given by their shape instead of by samples, and the edits they make. Coordinates are those
// of the output: spacing * sample index, the axis-aligned frame.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "storage/types/box.h"

namespace voxweld {

enum class SolidShape : std::uint8_t { sphere, box, cylinder, cone, torus, plane };

// In its own frame, where q = axes * (p - center), a solid is
//   sphere    |q| <= radius
//   box       |q| <= size / 2 on each axis
//   cylinder  x^2 + y^2 <= radius^2, |z| <= height / 2
//   cone      base of `radius` at z = -height / 2, tip at z = height / 2
//   torus     within `tube` of the circle of `radius` in the plane z = 0
//   plane     the half space z <= 0
// Points on the surface are inside.
struct Solid {
  SolidShape shape = SolidShape::sphere;
  Vec3 center;
  std::array<Vec3, 3> axes = {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};  // orthonormal rows
  Vec3 size;
  double radius = 0, height = 0, tube = 0;
  friend bool operator==(const Solid&, const Solid&) = default;
};

// Constructive solid geometry, in the order of the list.
enum class EditOp : std::uint8_t { add, subtract, intersect };

struct Edit {
  EditOp op = EditOp::add;
  Solid solid;
  friend bool operator==(const Edit&, const Edit&) = default;
};

using Edits = std::vector<Edit>;

}  // namespace voxweld
