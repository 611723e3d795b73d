// A solid that answers for the points and edges of one lattice of samples: sides, crossings and
// normals.
#pragma once

#include <cmath>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>

#include "stages/solids/solid.h"
#include "stages/solids/volume_frame.h"
#include "storage/support/hash.h"

namespace voxweld {

// Immutable; asked from any thread.
class LatticeSolid {
 public:
  virtual ~LatticeSolid() = default;

  // In the frame spacing * sample index. Outside of them all is outside.
  virtual const Bounds& bounds() const = 0;
  virtual Hash128 source() const = 0;  // of all that made it, for the keys of artifacts

  // One side change of a row of samples along x: of (x, y, z) and all after it in the row.
  struct Flip {
    std::int64_t x, y, z;
  };
  // Tells the flips of the rows through `samples` that come before its end, those before its first
  // sample at that, in any order. Without flips all of a row is outside.
  virtual void each_flip(const Box3& samples,
                         const std::function<void(const Flip&)>& flip) const = 0;

  struct Crossing {
    double t = 0.5;  // 0 at the edge's low end
    Vec3 normal;     // unit, outward
  };
  // Of the edge along `axis` from sample s to the next. Where it is crossed several times it is the
  // crossing nearest the outside end, as an `add` takes the outer of two surfaces: all of the solid
  // that lies on the edge stays in it, and the normal there leads out.
  // Precondition: the ends are on different sides; both are samples of the frame.
  virtual Crossing crossing(int axis, Index3 s, bool low_inside) const = 0;

  // On which side all of these samples are, where the surface keeps clear of their box; nothing
  // where it may not. Precondition: samples of the frame, not empty.
  virtual std::optional<bool> side(const Box3& samples) const {
    static_cast<void>(samples);
    return std::nullopt;
  }

  // What gives the same answers for these samples and the edges between them, fast; to be asked
  // once for each brick. Null where this does so itself.
  // Precondition: a brick's (stages/build/build_brick.h).
  virtual std::shared_ptr<const LatticeSolid> near(const Box3& samples) const {
    static_cast<void>(samples);
    return nullptr;
  }
};

// Corners of meshes are snapped to 2^-20 of a cell on each axis, so they move by at most 2^-21
// cells an axis: under a float's own resolution for meshes of more than 16 cells.
inline constexpr int mesh_cell_bits = 20;
inline constexpr std::int64_t mesh_cell = std::int64_t{1} << mesh_cell_bits;
inline Index3 snapped_corner(Vec3 place, Vec3 spacing) {
  Index3 steps;
  for (int a = 0; a < 3; ++a)
    steps[a] = std::llround(place[a] / spacing[a] * static_cast<double>(mesh_cell));
  return steps;
}
// lo, hi: in these steps.
inline Bounds snapped_bounds(Index3 lo, Index3 hi, Vec3 spacing) {
  Bounds bounds;
  for (int a = 0; a < 3; ++a) {
    bounds.lo[a] = static_cast<double>(lo[a]) / static_cast<double>(mesh_cell) * spacing[a];
    bounds.hi[a] = static_cast<double>(hi[a]) / static_cast<double>(mesh_cell) * spacing[a];
  }
  return bounds;
}

}  // namespace voxweld
