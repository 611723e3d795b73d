// Build's work on a volume in memory, brick by brick, cut in two where the paper begins to measure:
// behind the signed octree with its Hermite data, before it is simplified.
#pragma once

#include <vector>

#include "stages/build/cell_octree.h"
#include "tests/paper/model_volume.h"

namespace voxweld::paper {

struct HermiteBrick {
  Index3 at;
  BrickFrame frame;
  SignGrid signs;     // of one material
  LabelGrid labels;   // of several (labels.mode = "shared"), in place of the signs
  ActiveCells cells;  // none: the brick is homogeneous
  HermiteEdges edges;
  RootRecord root;  // as that of a homogeneous brick
};

// Of bricks without a sign change: whether their signs are kept, for edits to come.
enum class Homogeneous { keep, forget };
// Of all bricks but those that are known to be outside.
std::vector<HermiteBrick> hermite_data(const ModelVolume& model, Homogeneous homogeneous);
// What the edit makes of it, with nothing sampled anew: the paper's CSG on the signed octree.
void apply(const Edit& edit, const ModelVolume& model, HermiteBrick& brick);

class Simplifier {
 public:
  explicit Simplifier(const ModelVolume& model) : model_(model) {}
  // Clears `out` first.
  void simplify(const HermiteBrick& brick, BrickOctree& out);
  // Of all nodes with their QEFs that there were so far, had they been kept.
  std::uint64_t node_bytes() const { return node_bytes_; }

 private:
  template <class Grid>
  void simplify(const HermiteBrick& brick, const Grid& grid, BrickOctree& out);

  const ModelVolume& model_;
  CellOctreeScratch scratch_;
  std::uint64_t node_bytes_ = 0;
};

VolumeBricks no_bricks(const ModelVolume& model);
// By build_brick, as the program does.
VolumeBricks build_bricks(const ModelVolume& model);

// What differs first, or "".
std::string difference(const VolumeBricks& a, const VolumeBricks& b);

}  // namespace voxweld::paper
