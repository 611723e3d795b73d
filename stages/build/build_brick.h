// Build: the samples of one brick to its simplified octree, polygons, ghost layer and root record.
//
// Based on: Ju, Losasso, Schaefer, Warren, "Dual Contouring of Hermite Data", 2002. The brick is an
// aligned subtree of the volume's one octree, so nothing is approximated at its border; what it
// says of its cells depends on the volume and the parameters alone.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>

#include "stages/contouring/brick_grid.h"
#include "stages/contouring/parameters.h"
#include "stages/solids/solid.h"
#include "storage/types/brick_octree.h"
#include "storage/types/halo_block.h"

namespace voxweld {

struct BrickPlace {
  Index3 origin;  // lattice point of the brick's lowest corner, a multiple of its side
  int level = 6;  // 2^level cells a side, min_brick_level .. max_brick_level
};

inline BrickPlace place_of_brick(const BrickGrid& grid, Index3 brick) {
  return {brick * (std::int64_t{1} << grid.brick_level()), grid.brick_level()};
}

// The sample indices a brick reads, before clipping to the volume: its lattice points, those of
// Wenger's rule, and the gradient's reach.
Box3 halo_samples(const BrickPlace& place, const ContourParameters& parameters);

// The samples whose sides a brick looks at, before clipping to the volume.
Box3 sign_samples(const BrickPlace& place);
// The same, clipped.
inline Box3 sign_samples(const BrickGrid& grid, Index3 brick) {
  return intersect(sign_samples(place_of_brick(grid, brick)), Box3{{}, grid.size()});
}

// Where a brick's signs are looked at, in the frame spacing * sample index: edits that do not reach
// this far (stages/solids/solid.h) change nothing in the brick.
Bounds brick_bounds(const BrickPlace& place, Vec3 spacing);

// Working memory, reused from brick to brick: nothing is allocated once it has met the largest.
class BrickScratch {
 public:
  BrickScratch();
  ~BrickScratch();
  struct Parts;
  Parts& parts() { return *parts_; }

  // Called with the bytes that a brick takes, this memory and the result included, once its active
  // cells are counted and before anything large is allocated for it. May be empty. It may call
  // free_buffers and empty the result, and may throw.
  std::function<void(std::uint64_t)> reserve;
  // Gives what bricks so far have left here back to the system.
  void free_buffers();

 private:
  std::unique_ptr<Parts> parts_;
};

// Fills `out` (cleared first). Precondition: `block` holds halo_samples clipped to the volume.
void build_brick(const HaloBlock& block, const BrickPlace& place,
                 const ContourParameters& parameters, BrickScratch& scratch, BrickOctree& out);

// The same where no sample outside `extent` is inside, of those that lattice points -1 .. side + 1
// of the brick stand for: so long as the config has no edits it looks nowhere else.
void build_brick(const HaloBlock& block, const BrickPlace& place, const Box3& extent,
                 const ContourParameters& parameters, BrickScratch& scratch, BrickOctree& out);

// The same of one label of several, after the edits. block: of a MaterialBlock; surface.label: its
// number there; parameters.edits are not looked at, but the part's.
class LabelPart;
void build_brick(const HaloBlock& block, const BrickPlace& place, const LabelPart& part,
                 const ContourParameters& parameters, BrickScratch& scratch, BrickOctree& out);

// What build_brick gives where all samples its cells touch are on one side, and no edit reaches it. They are not
// looked at.
void build_whole_brick(const BrickPlace& place, NodeState side, BrickOctree& out);

// An upper bound on what build_brick and its result hold, in bytes, for the worst volume there is.
std::uint64_t build_brick_bytes(int level);
// The same for a brick with so many active cells.
std::uint64_t build_brick_bytes(int level, std::uint64_t active_cells);
// Both where each sheet collapses by itself; sheets: of all active cells. The second without what a
// label's filtered field takes (label_field.h).
std::uint64_t build_sheets_bytes(int level);
std::uint64_t build_sheets_bytes(int level, std::uint64_t active_cells, std::uint64_t sheets);
// And what it holds beyond that between labels (labels.mode = "shared"), each sample being another.
std::uint64_t build_labels_bytes(int level);
// And for one label of several where an edit replaces labels by it (label_part.h).
std::uint64_t build_replacing_bytes(int level);

}  // namespace voxweld
