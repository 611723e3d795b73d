// Cut: a brick's octree at a larger tolerance, from what build left of it at a smaller one, without
// samples. Where each sheet collapses by itself only (storage/types/brick_levels.h).
#pragma once

#include <cstdint>
#include <vector>

#include "storage/types/brick_octree.h"

namespace voxweld {

// An upper bound on what a cut holds, `finer` and the result included, where what build left of the
// brick takes so many bytes.
std::uint64_t cut_bytes(std::uint64_t brick_bytes);

// Whether every number in the octree names something of it. For what comes from files: a checksum
// only says that it is what was written.
bool can_be_cut(const BrickOctree& octree);

class BrickCutter {
 public:
  // Fills `out` (cleared first) with what build_brick makes at this tolerance, to the bit.
  // finer: all that build_brick made of the brick at a smaller one or the same. tolerance: as
  // SimplifyParameters has it. Preconditions: can_be_cut(finer); the two are not one.
  void cut(const BrickOctree& finer, double tolerance, BrickOctree& out);

 private:
  bool collapses(std::uint32_t kept) const;
  void follow_clusters();
  void list_vertices();
  void add_vertex(std::uint32_t from);
  void add_levels();
  void set_sharing();
  void cut_record();
  void cut_polygons();
  void cut_blocks();
  void cut_ghosts();

  const BrickOctree* finer_ = nullptr;
  double tolerance_ = 0;
  BrickOctree* out_ = nullptr;
  std::vector<std::uint32_t> top_;    // of kept clusters that collapse: the highest above that does
  std::vector<std::uint32_t> left_;   // of the others: place in the result's
  std::vector<std::uint32_t> place_;  // of finer's vertices: place in the result
  std::vector<std::uint32_t> cluster_place_;  // of its clusters that become vertices, the same
  std::vector<std::uint32_t> order_;          // of the result's: finer's vertex, or clusters | kept
  std::vector<std::uint32_t> marks_;
};

}  // namespace voxweld
