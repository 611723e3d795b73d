#include "stages/stitch/quad_split.h"

#include <algorithm>
#include <cmath>

namespace voxweld {
namespace {

// Differences have 23 bits, their products 46: every component is exact in a double.
Vec3 difference(const LatticePoint& a, const LatticePoint& b) {
  return {static_cast<double>(b[0] - a[0]), static_cast<double>(b[1] - a[1]),
          static_cast<double>(b[2] - a[2])};
}

struct Corner {
  LatticePoint point{};
  std::array<Vec3, max_clusters> normals;
  std::size_t count = 0;  // of normals
  bool either = false;    // sense
};

Corner unpack(const QuadCorner& packed) {
  Corner corner;
  corner.point = packed.point;
  corner.either = packed.sense == NormalSense::either;
  for (const PackedNormal n : packed.normals)
    if (n != no_normal) corner.normals[corner.count++] = unpack_normal(n);
  return corner;
}

// Against all its normals; a corner without any faces everything.
bool faces_away(const Corner& corner, const Vec3& area) {
  for (std::size_t k = 0; k < corner.count; ++k)
    if (dot(corner.normals[k], area) >= 0) return false;
  return corner.count > 0;
}

// Normals of either sense.
void turn_to_its_side(std::array<Corner, 4>& quad) {
  if (!std::any_of(quad.begin(), quad.end(), [](const Corner& c) { return c.either; })) return;
  const Vec3 area =
      cross(difference(quad[0].point, quad[2].point), difference(quad[1].point, quad[3].point));
  for (Corner& corner : quad)
    for (std::size_t k = 0; corner.either && k < corner.count; ++k)
      if (dot(corner.normals[k], area) < 0) corner.normals[k] = corner.normals[k] * -1.0;
}

struct Triangle {
  Vec3 area;
  int fault = 0;  // 1 where it faces away from a corner's normals, 2 where it has no area
};

Triangle triangle(const Corner& a, const Corner& b, const Corner& c) {
  Triangle t{area_vector(a.point, b.point, c.point)};
  if (t.area == Vec3{})
    t.fault = 2;
  else if (faces_away(a, t.area) || faces_away(b, t.area) || faces_away(c, t.area))
    t.fault = 1;
  return t;
}

double height(const Corner& corner, const Vec3& along) {
  double lowest = corner.count > 0 ? std::abs(dot(corner.normals[0], along)) : 0;
  for (std::size_t k = 1; k < corner.count; ++k)
    lowest = std::min(lowest, std::abs(dot(corner.normals[k], along)));
  return lowest;
}

// Cosine between the two triangles' normals; below any cosine when one has no area.
double flatness(const Vec3& u, const Vec3& v) {
  const double uu = dot(u, u), vv = dot(v, v);
  if (uu == 0 || vv == 0) return -2;
  return dot(u, v) / std::sqrt(uu * vv);
}

struct Cut {
  int fault;
  double height;  // in lattice steps
  double flatness;
  double length2;
  std::array<Vec3, 2> area;  // of its triangles
};

// The cut of the quad a b c d from a to c.
Cut cut(const Corner& a, const Corner& b, const Corner& c, const Corner& d) {
  const Triangle t = triangle(a, b, c), u = triangle(a, c, d);
  const Vec3 along = difference(a.point, c.point);
  return {std::max(t.fault, u.fault),
          height(a, along) + height(c, along),
          flatness(t.area, u.area),
          dot(along, along),
          {t.area, u.area}};
}

// The axis of the lattice edge that the quad's leaves have in common; -1 where they have no edge.
int edge_axis(const std::array<QuadCorner, 4>& quad) {
  Box3 common = quad[0].id.leaf().cells();
  for (const QuadCorner& corner : quad) common = intersect(common, corner.id.leaf().cells());
  int axis = -1;
  for (int a = 0; a < 3; ++a) {
    if (common.hi[a] == common.lo[a]) continue;
    if (common.hi[a] < common.lo[a] || axis >= 0) return -1;
    axis = a;
  }
  return axis;
}

// Seen along its edge, whether one of the cut's triangles lies the other way round than the quad.
bool turns_over(const Cut& cut, int axis) {
  return axis >= 0 && cut.area[0][axis] * cut.area[1][axis] < 0;
}

}  // namespace

Vec3 area_vector(const LatticePoint& a, const LatticePoint& b, const LatticePoint& c) {
  return cross(difference(a, b), difference(a, c));
}

bool cut_from_one(const std::array<QuadCorner, 4>& q) {
  std::array<Corner, 4> c{unpack(q[0]), unpack(q[1]), unpack(q[2]), unpack(q[3])};
  turn_to_its_side(c);
  const Cut zero = cut(c[0], c[1], c[2], c[3]), one = cut(c[1], c[2], c[3], c[0]);
  if (zero.fault != one.fault) return one.fault < zero.fault;
  if (zero.fault == 1) {
    const int axis = edge_axis(q);
    const bool zero_turns = turns_over(zero, axis), one_turns = turns_over(one, axis);
    if (zero_turns != one_turns) return zero_turns;
  }
  if (std::abs(zero.height - one.height) > 1) return one.height < zero.height;
  if (zero.flatness != one.flatness) return one.flatness > zero.flatness;
  if (zero.length2 != one.length2) return one.length2 < zero.length2;
  return std::min(q[1].id, q[3].id) < std::min(q[0].id, q[2].id);
}

}  // namespace voxweld
