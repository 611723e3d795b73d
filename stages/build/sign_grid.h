// The inside/outside bits of the lattice points around one brick, a row of bits for each (y, z).
#pragma once

#include <cstdint>
#include <cstring>
#include <vector>

#include "stages/build/collapse_rule.h"
#include "stages/contouring/cell_topology.h"
#include "stages/contouring/parameters.h"
#include "stages/solids/volume_frame.h"
#include "storage/types/halo_block.h"
#include "storage/types/solid.h"

namespace voxweld {

// Covers lattice points -1 .. side + 1 relative to the brick's lowest: what the signs of the cells
// -1 .. side need (Wenger's rule looks one cell beyond the brick).
class SignGrid : public CollapseRule {
 public:
  // brick: lattice point of the brick's lowest corner; side: cells a side.
  // Points without a sample are outside, and so are those of samples not in `extent`, which are not
  // looked at. Tests run in the sample's own type: equal to the isovalue is inside, NaN outside.
  void fill(const HaloBlock& block, Index3 brick, int side, const SurfaceParameters& surface,
            const Box3& extent);
  void fill(const HaloBlock& block, Index3 brick, int side, const SurfaceParameters& surface) {
    fill(block, brick, side, surface, block.samples);
  }

  // The points of the volume that lie in the solid; all others are outside.
  void fill(const Solid& solid, const VolumeFrame& frame, Index3 brick, int side);
  // Makes this what the edit leaves of it; `solid`: filled by the edit's solid for the same brick.
  void combine(EditOp op, const SignGrid& solid);

  // Relative coordinates, -1 .. side + 1.
  bool inside(int x, int y, int z) const {
    const int bit = x + 1;
    return (row(y, z)[bit >> 6] >> (bit & 63) & 1u) != 0;
  }
  // Corner signs of the cell at (x, y, z), each -1 .. side.
  CellSigns cell(int x, int y, int z) const {
    return static_cast<CellSigns>(pair(x, y, z) | pair(x, y + 1, z) << 2 | pair(x, y, z + 1) << 4 |
                                  pair(x, y + 1, z + 1) << 6);
  }
  // The 27 signs of the node of `side` cells at (x, y, z), at half its side.
  std::uint32_t signs27(int x, int y, int z, int node_side) const;

  bool allows(int x, int y, int z, int node_side) const override {
    return signs_allow_collapse(signs27(x, y, z, node_side));
  }

  NodeCrossings crossings(int x, int y, int z) const override;

  // Bits of the row at relative (y, z); bit i is x = i - 1. words() words, then one of zeros.
  const std::uint64_t* row(int y, int z) const {
    return bits_.data() +
           (static_cast<std::size_t>(z + 1) * points_ + static_cast<std::size_t>(y + 1)) * stride_;
  }
  std::size_t words() const { return stride_ - 1; }
  // Whether all points are on one side.
  bool is_uniform() const;

 private:
  void fill_shape(const Solid& solid, const VolumeFrame& frame, Index3 first, const Box3& held);
  void fill_mesh(const LatticeSolid& mesh, Index3 first, const Box3& held);
  std::uint64_t* row_at(std::int64_t y, std::int64_t z) {  // counted from the grid's first
    return bits_.data() +
           (static_cast<std::size_t>(z) * points_ + static_cast<std::size_t>(y)) * stride_;
  }
  // Signs of x and x + 1, in bits 0 and 1.
  unsigned pair(int x, int y, int z) const {
    std::uint32_t word;
    std::memcpy(&word, reinterpret_cast<const unsigned char*>(row(y, z)) + (x + 1) / 8,
                sizeof word);
    return word >> ((x + 1) & 7) & 3u;
  }

  std::size_t points_ = 0;  // a side
  std::size_t stride_ = 0;  // words a row, the last one zero
  std::vector<std::uint64_t> bits_;
};

}  // namespace voxweld
