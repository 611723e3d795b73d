// The sum of squared distances to planes, weighted by area (Garland and Heckbert, "Surface
// Simplification Using Quadric Error Metrics", 1997).
#pragma once

#include <algorithm>

#include "storage/types/box.h"

namespace voxweld {

struct Quadric {
  // x^T A x + 2 b . x + c, and the sum of the weights.
  double xx = 0, yy = 0, zz = 0, xy = 0, xz = 0, yz = 0;
  Vec3 b{};
  double c = 0, weight = 0;

  static Quadric of_plane(Vec3 n, double d, double weight) {  // n . x + d = 0, n of unit length
    return {weight * n.x * n.x, weight * n.y * n.y, weight * n.z * n.z,
            weight * n.x * n.y, weight * n.x * n.z, weight * n.y * n.z,
            n * (weight * d),   weight * d * d,     weight};
  }
  Quadric& operator+=(const Quadric& o) {
    xx += o.xx;
    yy += o.yy;
    zz += o.zz;
    xy += o.xy;
    xz += o.xz;
    yz += o.yz;
    b = b + o.b;
    c += o.c;
    weight += o.weight;
    return *this;
  }
  double operator()(Vec3 p) const {
    const double x = xx * p.x + xy * p.y + xz * p.z + 2 * b.x;
    const double y = xy * p.x + yy * p.y + yz * p.z + 2 * b.y;
    const double z = xz * p.x + yz * p.y + zz * p.z + 2 * b.z;
    return std::max(0.0, x * p.x + y * p.y + z * p.z + c);
  }
  // The mean of the squared distances.
  double squared_distance(Vec3 p) const { return weight > 0 ? (*this)(p) / weight : 0; }

  // Where it is least; of flat and straight places the one nearest to `near`: a pull there that is
  // small beside what a plane weighs.
  Vec3 minimiser(Vec3 near) const {
    const double pull = 1e-3 * (xx + yy + zz);
    if (!(pull > 0)) return near;
    const double a = xx + pull, d = yy + pull, f = zz + pull;
    const Vec3 r{-b.x + pull * near.x, -b.y + pull * near.y, -b.z + pull * near.z};
    const double c0 = d * f - yz * yz, c1 = xz * yz - xy * f, c2 = xy * yz - xz * d;
    const double det = a * c0 + xy * c1 + xz * c2;
    if (!(det > 0)) return near;
    return {(c0 * r.x + c1 * r.y + c2 * r.z) / det,
            (c1 * r.x + (a * f - xz * xz) * r.y + (xy * xz - a * yz) * r.z) / det,
            (c2 * r.x + (xy * xz - a * yz) * r.y + (a * d - xy * xy) * r.z) / det};
  }
};

}  // namespace voxweld
