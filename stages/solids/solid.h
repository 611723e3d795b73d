// The mathematics of solids given by their shape (storage/types/solid.h): sides of points, exact
// crossings and normals of edges, and whether an edit can change anything in a box.
//
// Nothing here but IEEE + - * / sqrt on the point's own coordinates, so a lattice point is on the
// same side whatever brick, process or machine asks.
#pragma once

#include <optional>
#include <span>

#include "storage/types/solid.h"

namespace voxweld {

// Meshes answer for lattice points and edges (stages/solids/mesh_solid.h): the first four
// functions are for the other shapes.
//
// At most 0 inside; continuous, and near the surface about the distance.
double solid_value(const Solid& solid, Vec3 p);
inline bool solid_holds(const Solid& solid, Vec3 p) {
  return solid_value(solid, p) <= 0;
}
// Unit, outward: of the face nearest to p, which should be on the surface.
Vec3 solid_normal(const Solid& solid, Vec3 p);

// Where the edge from `low` over `length` along `axis` crosses the surface, in [0, 1], to 2^-40.
// Precondition: its ends are on different sides.
double solid_crossing(const Solid& solid, Vec3 low, int axis, double length);

struct Bounds {
  Vec3 lo, hi;
};
// Infinite where the solid is.
Bounds solid_bounds(const Solid& solid);

// Where a box lies, for certain: `mixed` is everything that is not.
enum class Relation : std::uint8_t { outside, inside, mixed };
Relation relation_to(const Solid& solid, const Bounds& box);

// Whether what lies in the box can differ from what it would be without the edit.
bool edit_reaches(const Edit& edit, const Bounds& box);

// On which side a box lies after the edits when it lay on `side` before; `mixed` where only its
// points can tell.
// Between labels `inside` is any of them.
// samples: all those in the box, for what meshes know of them; none, and they are not asked.
Relation side_after(std::span<const Edit> edits, const Bounds& box, Relation side,
                    const Box3& samples = {});

// Of which material all of a box is after the edits, when all of it was of `before`; nothing stands
// for not knowing, then and now.
std::optional<Material> material_after(std::span<const Edit> edits, const Bounds& box,
                                       std::optional<Material> before);

}  // namespace voxweld
