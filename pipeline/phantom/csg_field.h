// A solid of primitives as a field, with its exact surface distance.
#pragma once

#include <cstdint>

#include "pipeline/phantom/csg_model.h"
#include "pipeline/phantom/csg_surface.h"
#include "pipeline/phantom/fields.h"

namespace voxweld {

// d = s times the running minimum (union) and maximum (subtraction, negated) of the primitives'
// signed distances at q = M (p - c) / s, s = N / 512. Its sign is right everywhere and |d| never
// exceeds the distance to the surface; surface_distance() is that distance, to 1e-6 voxel.
class CsgField : public AnalyticField {
 public:
  CsgField(const CsgModel& model, std::int64_t size);
  void fill(const Box3& box, double limit, double* out) const override;
  Index3 block() const override { return {16, 8, 8}; }
  std::uint64_t scratch_bytes() const override { return 1 << 16; }
  double at(Vec3 p) const override;
  double surface_distance(Vec3 p) const override;

 private:
  Vec3 to_model(Vec3 p) const;

  CsgSurface surface_;
  double centre_, scale_;
};

}  // namespace voxweld
