#include "stages/solids/solid.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "stages/solids/lattice_solid.h"

namespace voxweld {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

Vec3 to_own(const Solid& solid, Vec3 p) {
  const Vec3 d = p - solid.center;
  return {dot(solid.axes[0], d), dot(solid.axes[1], d), dot(solid.axes[2], d)};
}

Vec3 to_world(const Solid& solid, Vec3 v) {
  return solid.axes[0] * v.x + solid.axes[1] * v.y + solid.axes[2] * v.z;
}

double from_axis(Vec3 q) {
  return std::sqrt(q.x * q.x + q.y * q.y);
}

// Away from the own z axis; any direction on it.
Vec3 radial(Vec3 q) {
  const double rho = from_axis(q);
  return rho > 0 ? Vec3{q.x / rho, q.y / rho, 0} : Vec3{1, 0, 0};
}

Vec3 unit(Vec3 v, Vec3 otherwise) {
  const double length = std::sqrt(dot(v, v));
  return length > 0 ? v * (1 / length) : otherwise;
}

// A face of a solid as seen from a point: how far outside of it the point is, and its normal.
struct Face {
  double value;
  Vec3 normal;
};

Face outermost(std::initializer_list<Face> faces) {
  return *std::max_element(faces.begin(), faces.end(),
                           [](const Face& a, const Face& b) { return a.value < b.value; });
}

Face slab(double x, double half, Vec3 axis) {
  return x < 0 ? Face{-x - half, axis * -1.0} : Face{x - half, axis};
}

// In the solid's own frame.
Face face_at(const Solid& s, Vec3 q) {
  const Vec3 x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};
  switch (s.shape) {
    case SolidShape::sphere:
      return {std::sqrt(dot(q, q)) - s.radius, unit(q, z)};
    case SolidShape::box:
      return outermost(
          {slab(q.x, s.size.x / 2, x), slab(q.y, s.size.y / 2, y), slab(q.z, s.size.z / 2, z)});
    case SolidShape::cylinder:
      return outermost({{from_axis(q) - s.radius, radial(q)}, slab(q.z, s.height / 2, z)});
    case SolidShape::cone: {
      const double slant = std::sqrt(s.height * s.height + s.radius * s.radius);
      const double out = (from_axis(q) * s.height + (q.z - s.height / 2) * s.radius) / slant;
      const Vec3 side = radial(q) * (s.height / slant) + z * (s.radius / slant);
      return outermost({{out, side}, {-q.z - s.height / 2, z * -1.0}});
    }
    case SolidShape::torus: {
      const Vec3 away = radial(q);
      const Vec3 d = q - away * s.radius;
      return {std::sqrt(dot(d, d)) - s.tube, unit(d, z)};
    }
    case SolidShape::plane:
      return {q.z, z};
    case SolidShape::mesh:  // see the preconditions
      break;
  }
  return {infinite, z};
}

bool is_convex(const Solid& solid) {
  return solid.shape != SolidShape::torus && solid.shape != SolidShape::mesh;
}

Vec3 corner(const Bounds& box, int i) {
  return {(i & 1) != 0 ? box.hi.x : box.lo.x, (i & 2) != 0 ? box.hi.y : box.lo.y,
          (i & 4) != 0 ? box.hi.z : box.lo.z};
}

// Half the extent of the solid's own box, on its own axes.
Vec3 half_size(const Solid& s) {
  switch (s.shape) {
    case SolidShape::sphere:
      return {s.radius, s.radius, s.radius};
    case SolidShape::box:
      return s.size * 0.5;
    case SolidShape::cylinder:
    case SolidShape::cone:
      return {s.radius, s.radius, s.height / 2};
    case SolidShape::torus:
      return {s.radius + s.tube, s.radius + s.tube, s.tube};
    case SolidShape::plane:
    case SolidShape::mesh:
      break;
  }
  return {infinite, infinite, infinite};
}

// Rounding shall not put a point on one side and the box that holds it on the other.
double rounding_margin(const Bounds& box, const Solid& solid) {
  double largest = 0;
  for (int a = 0; a < 3; ++a)
    largest = std::max({largest, std::abs(box.lo[a]), std::abs(box.hi[a]),
                        std::abs(solid.center[a]), solid.size[a]});
  return 1e-9 * (largest + solid.radius + solid.height + solid.tube);
}

Relation relation_to(const Solid& solid, const Bounds& box, const Box3& samples) {
  const Relation relation = relation_to(solid, box);
  if (relation != Relation::mixed || solid.shape != SolidShape::mesh || samples.empty())
    return relation;
  const std::optional<bool> side = solid.mesh->side(samples);
  return !side ? Relation::mixed : *side ? Relation::inside : Relation::outside;
}

}  // namespace

double solid_value(const Solid& solid, Vec3 p) {
  return face_at(solid, to_own(solid, p)).value;
}

Vec3 solid_normal(const Solid& solid, Vec3 p) {
  return to_world(solid, face_at(solid, to_own(solid, p)).normal);
}

double solid_crossing(const Solid& solid, Vec3 low, int axis, double length) {
  const bool low_inside = solid_holds(solid, low);
  double begin = 0, end = 1;
  for (int step = 0; step < 40; ++step) {
    const double middle = 0.5 * (begin + end);
    Vec3 p = low;
    p[axis] += middle * length;
    (solid_holds(solid, p) == low_inside ? begin : end) = middle;
  }
  return 0.5 * (begin + end);
}

Bounds solid_bounds(const Solid& solid) {
  if (solid.shape == SolidShape::mesh) return solid.mesh->bounds();
  const Vec3 half = half_size(solid);
  Bounds bounds;
  for (int a = 0; a < 3; ++a) {
    double reach = 0;
    for (std::size_t own = 0; own < 3; ++own) {
      const double share = std::abs(solid.axes[own][a]);
      if (share > 0) reach += share * half[static_cast<int>(own)];
    }
    bounds.lo[a] = solid.center[a] - reach;
    bounds.hi[a] = solid.center[a] + reach;
  }
  return bounds;
}

Relation relation_to(const Solid& solid, const Bounds& box) {
  const double margin = rounding_margin(box, solid);
  const Bounds bounds = solid_bounds(solid);
  for (int a = 0; a < 3; ++a)
    if (box.hi[a] < bounds.lo[a] - margin || box.lo[a] > bounds.hi[a] + margin)
      return Relation::outside;
  // Only its triangles could tell that a box is inside.
  if (solid.shape == SolidShape::mesh) return Relation::mixed;
  double least = infinite, most = -infinite;
  for (int i = 0; i < 8; ++i) {
    const double value = solid_value(solid, corner(box, i));
    least = std::min(least, value);
    most = std::max(most, value);
  }
  if (solid.shape == SolidShape::plane && least > margin) return Relation::outside;
  if (is_convex(solid) && most < -margin) return Relation::inside;
  return Relation::mixed;
}

bool edit_reaches(const Edit& edit, const Bounds& box) {
  const Relation relation = relation_to(edit.solid, box);
  return relation != (edit.op == EditOp::intersect ? Relation::inside : Relation::outside);
}

Relation side_after(std::span<const Edit> edits, const Bounds& box, Relation side,
                    const Box3& samples) {
  for (const Edit& edit : edits) {
    const Relation relation = relation_to(edit.solid, box, samples);
    // What the edit makes of points in its solid and of those out of it; the others stay.
    if (edit.op == EditOp::replace) continue;  // of labels: whatever is inside stays so
    const Relation made = edit.op == EditOp::add ? Relation::inside : Relation::outside;
    const Relation by = edit.op == EditOp::intersect ? Relation::outside : Relation::inside;
    if (relation == by) side = made;
    if (relation == Relation::mixed && side != made) side = Relation::mixed;
  }
  return side;
}

std::optional<Material> material_after(std::span<const Edit> edits, const Bounds& box,
                                       std::optional<Material> before) {
  std::optional<Material> now = before;
  for (const Edit& edit : edits) {
    const bool replaces = edit.op == EditOp::replace;
    if (replaces && now == exterior) continue;
    const Material made = gives_material(edit.op) ? edit.material : exterior;
    const Relation relation = relation_to(edit.solid, box);
    const Relation by = edit.op == EditOp::intersect ? Relation::outside : Relation::inside;
    if (relation == by && (now || !replaces))
      now = made;
    else if (relation == by || (relation == Relation::mixed && now != made))
      now.reset();
  }
  return now;
}

}  // namespace voxweld
