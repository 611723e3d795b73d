// The smooth phantoms: sphere, torus, gyroid.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "pipeline/phantom/fields.h"

namespace voxweld {

// d = |p - c| - 0.4 N. The distance is |d|, exactly.
class SphereField : public AnalyticField {
 public:
  explicit SphereField(std::int64_t size);
  void fill(const Box3& box, double limit, double* out) const override;
  Index3 block() const override { return {64, 4, 4}; }
  double at(Vec3 p) const override;
  double surface_distance(Vec3 p) const override;

 private:
  double centre_, radius_;
};

// q = Ry(0.5) Rx(0.4) (p - c); d = sqrt((sqrt(qx^2 + qy^2) - 0.29 N)^2 + qz^2) - 0.12 N: a ring
// that no axis lines up with. The distance is |d|, exactly.
class TorusField : public AnalyticField {
 public:
  explicit TorusField(std::int64_t size);
  void fill(const Box3& box, double limit, double* out) const override;
  Index3 block() const override { return {64, 4, 4}; }
  double at(Vec3 p) const override;
  double surface_distance(Vec3 p) const override;

 private:
  double centre_, ring_, tube_;
  std::array<Vec3, 3> rows_;
};

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

  double centre_, radius_, wavenumber_, amplitude_, blend_;
  std::array<Table, 3> tables_;
};

}  // namespace voxweld
