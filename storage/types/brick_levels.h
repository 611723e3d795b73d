// What a brick keeps of the levels above its vertices, so that the octree of any larger tolerance is
// a cut of it, without samples. Where each sheet collapses by itself only.
//
// Whether a cluster may collapse does not depend on the tolerance, nor does its error: QEFs are
// merged whatever collapses. At a tolerance t the vertices are the clusters whose error is at most t
// and that of all their ancestors above t. So of those above the vertices only these are kept whose
// error is below all of their ancestors'.
#pragma once

#include <cstdint>
#include <vector>

#include "storage/types/leaf_vertex.h"

namespace voxweld {

struct KeptCluster {
  LeafVertex vertex;         // shares its node: with clusters of that very node
  float error = 0;           // above those of what it takes in, in units of the tolerance
  std::uint32_t parent = 0;  // the next one above that is kept, or BrickLevels::none
};

// From this error on a block counts fewer vertices (BlockCount).
struct BlockMerge {
  static constexpr std::uint32_t most_fewer = (1u << 20) - 1;
  float error = 0;
  std::uint32_t block_fewer = 0;  // block << 20 | how many fewer
  static constexpr BlockMerge make(float error, std::uint32_t block, std::uint32_t fewer) {
    return {error, block << 20 | fewer};
  }
  constexpr std::uint32_t block() const { return block_fewer >> 20; }
  constexpr std::uint32_t fewer() const { return block_fewer & most_fewer; }
};

struct BrickLevels {
  static constexpr std::uint32_t none = 0xffffffffu;
  // Beside BrickOctree::vertices: their residuals, and the clusters that would take them in next.
  std::vector<float> errors;
  std::vector<std::uint32_t> parents;
  std::vector<KeptCluster> clusters;  // in the order of vertices: a parent before what it takes in
  std::vector<BlockMerge> merges;

  void clear() {
    errors.clear();
    parents.clear();
    clusters.clear();
    merges.clear();
  }
};

}  // namespace voxweld
