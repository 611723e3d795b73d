// The smooth phantoms: sphere, torus, gyroid.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "pipeline/phantom/fields.h"
#include "pipeline/phantom/rotation.h"

namespace voxweld {

// |p - c| - R.
struct Ball {
  explicit Ball(std::int64_t size, double share = 0.4)  // R = 0.4 N
      : centre((static_cast<double>(size) - 1) / 2), radius(share * static_cast<double>(size)) {}
  double operator()(Vec3 p) const { return length(p - Vec3{centre, centre, centre}) - radius; }

  double centre, radius;
};

// q = Ry(0.5) Rx(0.4) (p - c); sqrt((sqrt(qx^2 + qy^2) - 0.29 N)^2 + qz^2) - 0.12 N: a ring that no
// axis lines up with.
struct Ring {
  explicit Ring(std::int64_t size);
  double operator()(Vec3 p) const {
    const Vec3 q = apply(rows, p - Vec3{centre, centre, centre});
    const double radial = std::sqrt(q.x * q.x + q.y * q.y) - ring;
    return std::sqrt(radial * radial + q.z * q.z) - tube;
  }

  double centre, ring, tube;
  Rows rows;
};

// d = solid(p); the distance is |d|, exactly.
template <class Solid>
class DistanceField : public AnalyticField {
 public:
  explicit DistanceField(const Solid& solid) : solid_(solid) {}
  void fill(const Box3& box, double /*limit*/, double* out) const override {
    fill_by_point(box, out, [solid = solid_](Vec3 p) { return solid(p); });
  }
  Index3 block() const override { return {64, 4, 4}; }
  double at(Vec3 p) const override { return solid_(p); }
  double surface_distance(Vec3 p) const override { return std::abs(at(p)); }

 private:
  Solid solid_;
};
using SphereField = DistanceField<Ball>;
using TorusField = DistanceField<Ring>;

// R = 0.45 N, k = 2 pi / (N / 10), a = 1 / (1.4 k); X = k (x - c) + 0.3, Y = k (y - c) + 0.7,
// Z = k (z - c) + 1.1;
//   g = a (sin X cos Y + sin Y cos Z + sin Z cos X),  b = |p - c| - R,  d = smax(g, b, 6 N / 512)
//   smax(u, v, r) = max(u, v) + h^2 / (4 r),  h = max(r - |u - v|, 0)
// The distance is |d| / |grad d|: of first order, right to a few thousandths of a voxel within one
// voxel of the surface.
class GyroidField : public AnalyticField {
 public:
  explicit GyroidField(std::int64_t size);
  void fill(const Box3& box, double limit, double* out) const override;
  Index3 block() const override { return {128, 4, 4}; }
  double at(Vec3 p) const override;
  double surface_distance(Vec3 p) const override;

 private:
  struct Wave {
    double sine, cosine;
  };
  // Sine and cosine at every sample position of one axis.
  struct Table {
    std::vector<double> sine, cosine;
  };
  Wave wave(int axis, double coordinate) const;

  Ball ball_;
  double wavenumber_, amplitude_, blend_;
  std::array<Table, 3> tables_;
};

}  // namespace voxweld
