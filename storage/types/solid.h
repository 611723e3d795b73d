// Solids given by their shape instead of by samples, and the edits they make. Coordinates are those
// of the output: spacing * sample index, the axis-aligned frame.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "storage/types/box.h"
#include "storage/types/material.h"

namespace voxweld {

class LatticeSolid;  // stages/solids/lattice_solid.h

enum class SolidShape : std::uint8_t { sphere, box, cylinder, cone, torus, plane, mesh };

// In its own frame, where q = axes * (p - center), a solid is
//   sphere    |q| <= radius
//   box       |q| <= size / 2 on each axis
//   cylinder  x^2 + y^2 <= radius^2, |z| <= height / 2
//   cone      base of `radius` at z = -height / 2, tip at z = height / 2
//   torus     within `tube` of the circle of `radius` in the plane z = 0
//   plane     the half space z <= 0
//   mesh      what a row out of q crosses an odd number of times, or what they wind around, of
//             triangles * scale
// Points on the surface are inside; those on a mesh's where a step to higher x, y, z leads in.
struct Solid {
  SolidShape shape = SolidShape::sphere;
  Vec3 center;
  std::array<Vec3, 3> axes = {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};  // orthonormal rows
  Vec3 size;
  double radius = 0, height = 0, tube = 0;
  double scale = 1;
  // Of a mesh alone, in its place already; compared as a pointer.
  std::shared_ptr<const LatticeSolid> mesh;
  friend bool operator==(const Solid&, const Solid&) = default;
};

// Constructive solid geometry, in the order of the list. Between labels (labels.mode):
//   add        what lies in the solid becomes `material`
//   subtract   what lies in it becomes exterior
//   intersect  what lies outside it becomes exterior
//   replace    what lies in it and is not exterior becomes `material`
// Of one material there is nothing to replace.
enum class EditOp : std::uint8_t { add, subtract, intersect, replace };

constexpr bool gives_material(EditOp op) {
  return op == EditOp::add || op == EditOp::replace;
}

struct Edit {
  EditOp op = EditOp::add;
  Solid solid;
  Material material = exterior;  // of labels, with add and replace
  friend bool operator==(const Edit&, const Edit&) = default;
};

using Edits = std::vector<Edit>;

}  // namespace voxweld
