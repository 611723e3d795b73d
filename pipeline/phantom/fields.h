// The phantoms as functions of position. Positions are in voxels: sample (i, j, k) lies at
// (i, j, k), whatever the spacing; N samples a side have their centre at c = (N - 1) / 2. Values
// are in voxels too, negative inside.
#pragma once

#include <cstdint>
#include <memory>

#include "pipeline/phantom/kinds.h"
#include "storage/types/box.h"

namespace voxweld {

// Values at sample positions. Everything is const and may be called from many threads at once;
// the same sample has the same bits in whatever box it is asked for.
class PhantomField {
 public:
  virtual ~PhantomField() = default;

  // Fills out with the values at the samples of box, x fastest, tightly packed. A value beyond
  // +-limit may be replaced by any other of the same sign beyond it.
  virtual void fill(const Box3& box, double limit, double* out) const = 0;

  // The boxes fill() is best asked for; larger requests are cut into such.
  virtual Index3 block() const = 0;
  // Bytes fill() allocates for a box of at most that size, beyond out.
  virtual std::uint64_t scratch_bytes() const { return 0; }
};

// Fills out with value(p) at the samples of box, as fill() has them.
template <class F>
void fill_by_point(const Box3& box, double* out, F&& value) {
  for (std::int64_t z = box.lo.z; z < box.hi.z; ++z)
    for (std::int64_t y = box.lo.y; y < box.hi.y; ++y)
      for (std::int64_t x = box.lo.x; x < box.hi.x; ++x)
        *out++ =
            value(Vec3{static_cast<double>(x), static_cast<double>(y), static_cast<double>(z)});
}

// A field known at every point, with its surface.
class AnalyticField : public PhantomField {
 public:
  virtual double at(Vec3 p) const = 0;
  // The distance from p to the surface at() = 0, in voxels, not negative. How exact: see each
  // field.
  virtual double surface_distance(Vec3 p) const = 0;
};

// Seeds matter to labels, porous and noise only. InputError unless 1 <= size <= 2^19 - 2.
std::unique_ptr<const PhantomField> make_phantom_field(PhantomKind kind, std::int64_t size,
                                                       std::uint64_t seed);
// sphere, torus, gyroid, part and temple; InputError for the others, which have no surface that is
// known (junctions has several: junctions_field.h).
std::unique_ptr<const AnalyticField> make_analytic_field(PhantomKind kind, std::int64_t size);

}  // namespace voxweld
