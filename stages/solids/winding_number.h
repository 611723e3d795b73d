// How often a triangle mesh winds around a point: 1 inside of a closed mesh that faces outward, 0
// outside, and something between where there are holes.
//
// Based on: Jacobson, Kavan, Sorkine-Hornung, "Robust Inside-Outside Segmentation using Generalized
// Winding Numbers", ACM Trans. Graphics 32(4), 2013; Barill, Dickson, Schmidt, Levin, Jacobson,
// "Fast Winding Numbers for Soups and Clouds", ACM Trans. Graphics 37(4), 2018; van Oosterom,
// Strackee, "The Solid Angle of a Plane Triangle", IEEE Trans. Biomed. Eng. 30(2), 1983.
//
// It differs in that nothing depends on how far clusters are trusted: the expansion of each comes
// with a bound of its error, and clusters are opened until no doubt is left. Near 1/2 the number is
// found from its boundary: with a fan of triangles over the edges that have none on the other side
// the mesh is closed, so the two numbers add up to a whole one, and the rough sum says which. So
// the side of a point is that of the number itself, to rounding, and a function of mesh and point
// alone.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "stages/solids/solid.h"
#include "storage/types/triangle_mesh.h"

namespace voxweld {

class WindingNumber {
 public:
  WindingNumber() = default;
  // A mesh whose triangles face inward on the whole is turned around. The order of triangles does
  // not matter.
  explicit WindingNumber(const TriangleMesh& mesh);

  // Whether the number is at least 1/2. Points should lie on no triangle: there it jumps.
  bool inside(Vec3 p) const;
  // Of all points of the box, where one look can tell.
  Relation side_of(const Bounds& box) const;
  // Whether a triangle may meet the box.
  bool touches(const Bounds& box) const;

  // f(t, normal) of each triangle that the line from `from` over `length` along the axis meets: t
  // in [0, 1], and its normal, unit, as the mesh faces.
  template <class F>
  void each_meeting(Vec3 from, int axis, double length, F&& f) const;

  // To rounding where the open edges are few, else to 1e-6.
  double value(Vec3 p) const;
  // Towards where it grows, where no triangle is: what the open edges make of it alone.
  Vec3 gradient(Vec3 p) const;

  // -1 where the mesh was turned around, else 1.
  double orientation() const { return orientation_; }
  std::size_t open_edges() const { return edges_.size(); }
  std::uint64_t bytes() const;  // of memory it holds

 private:
  struct Triangle {
    std::array<Vec3, 3> corners;
  };
  template <class F>  // f(triangle)
  void each_near(const Bounds& box, F&& f) const;
  struct Meeting {
    double t;
    Vec3 normal;
  };
  static std::optional<Meeting> meeting(const Triangle& triangle, Vec3 from, int axis,
                                        double length);
  // Triangles that are seen as one from afar: a dipole and the next term of the expansion about
  // their centre of mass.
  struct Cluster {
    Vec3 center;
    double radius = 0, area = 0;     // all corners lie within; sum of areas
    Vec3 normal;                     // sum of area * normal
    std::array<double, 6> moment{};  // of area * offset * normal: xx, yy, zz, 2 xy, 2 xz, 2 yz
    Bounds bounds;
    std::uint32_t begin = 0, end = 0;  // its triangles
    std::uint32_t other = 0;           // second child, the first is the next; 0: no children
  };
  // A directed edge that has more triangles on its left than on its right.
  struct OpenEdge {
    Vec3 from, to;
    double count = 0;  // how many more
  };
  struct Sum {
    double value = 0, error = 0;
  };

  void find_open_edges(const TriangleMesh& mesh);
  std::uint32_t build(std::uint32_t begin, std::uint32_t end);
  Cluster summary(std::uint32_t begin, std::uint32_t end) const;
  Sum estimate(Vec3 p, double reach, double each) const;
  void add(std::uint32_t cluster, Vec3 p, double reach, double each, Sum& sum) const;
  double fan_angle(Vec3 p) const;
  double change_within(Vec3 p, double reach) const;

  std::vector<Triangle> triangles_;
  std::vector<Cluster> clusters_;  // the first holds all
  std::vector<OpenEdge> edges_;
  Vec3 apex_;  // of the fan over the open edges
  Vec3 edges_center_;
  double edges_radius_ = 0, edges_length_ = 0;
  double orientation_ = 1;
};

template <class F>
void WindingNumber::each_near(const Bounds& box, F&& f) const {
  std::array<std::uint32_t, 64> open;  // halves of halves: no tree of 2^32 is deeper
  std::size_t count = 0;
  if (!clusters_.empty()) open[count++] = 0;
  while (count > 0) {
    const std::uint32_t at = open[--count];
    const Cluster& cluster = clusters_[at];
    bool apart = false;
    for (int a = 0; a < 3; ++a)
      apart = apart || cluster.bounds.lo[a] > box.hi[a] || cluster.bounds.hi[a] < box.lo[a];
    if (apart) continue;
    if (cluster.other != 0) {
      open[count++] = cluster.other;
      open[count++] = at + 1;
      continue;
    }
    for (std::uint32_t i = cluster.begin; i < cluster.end; ++i)
      if (!f(triangles_[i])) return;
  }
}

template <class F>
void WindingNumber::each_meeting(Vec3 from, int axis, double length, F&& f) const {
  Bounds line{from, from};
  line.hi[axis] += length;
  each_near(line, [&](const Triangle& triangle) {
    if (const auto met = meeting(triangle, from, axis, length))
      f(met->t, met->normal * orientation_);
    return true;
  });
}

}  // namespace voxweld
