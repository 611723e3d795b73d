// Edits of a brick's labels, on its Hermite data: the cut edges are sharp.
//
// Based on: Ju, Losasso, Schaefer, Warren, "Dual Contouring of Hermite Data", 2002, section 2.3
// (constructive solid geometry of several materials).
#pragma once

#include "stages/build/hermite.h"
#include "stages/build/label_grid.h"
#include "stages/solids/volume_frame.h"
#include "storage/types/solid.h"

namespace voxweld {

class LabelEdits {
 public:
  // What the edit makes of the brick. labels, edges: before, and then after it.
  // Precondition: edit.material, where the edit gives one, is among labels.materials().
  void apply(const Edit& edit, const VolumeFrame& frame, Index3 brick, LabelGrid& labels,
             HermiteEdges& edges);

 private:
  void give_labels(const Edit& edit, LabelGrid& labels) const;
  HermiteEdge edge_after(const Edit& edit, const VolumeFrame& frame, Index3 brick, int axis,
                         Index3 at, const LabelGrid& labels) const;

  SignGrid solid_;
  LabelGrid before_;
  HermiteEdges edges_before_;
};

}  // namespace voxweld
