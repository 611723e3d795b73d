// Crossings and normals between the labels of one brick.
//
// Between labels a and b the surface is where their indicators are equal after the filter of
// label_field.h, corrected as label_edge.h does: the level 0 of their difference. Away from other
// labels that is the surface of either label by itself, to the bit; where three or four meet, the
// surfaces of all pairs meet too.
#pragma once

#include <vector>

#include "stages/build/hermite.h"
#include "stages/build/label_field.h"
#include "stages/build/label_grid.h"

namespace voxweld {

class LabelHermite {
 public:
  // Fills `out` with all crossing edges of the brick's cells; normals point out of the smaller
  // label. samples: as numbers of labels.materials(), held around the brick as far as
  // halo_samples() says.
  void compute(const HaloBlock& samples, Index3 brick, const LabelGrid& labels, Vec3 spacing,
               HermiteEdges& out);

  // What it holds at most: of one block of lattice points a field for each of its points.
  static std::uint64_t memory_bytes();

 private:
  struct Edge {
    std::uint32_t low, high;  // labels
    int axis, x, y, z;
    std::uint64_t pair() const {
      return low < high ? std::uint64_t{low} << 32 | high : std::uint64_t{high} << 32 | low;
    }
  };
  void find_edges(const LabelGrid& labels, int x0, int y0, int z0);
  void compute_block(const HaloBlock& samples, Index3 brick, Index3 first, int side, Vec3 spacing,
                     HermiteEdges& out);
  void subtract(std::uint32_t a, std::uint32_t b);
  const HaloBlock& field_of(const HaloBlock& samples, std::uint32_t label);

  // The fields of one block of lattice points: filtered once for each label.
  struct Field {
    std::uint32_t label = 0;
    LabelField filter;
    HaloBlock block;
  };
  std::vector<Edge> edges_;
  std::vector<Field> fields_;
  std::size_t used_ = 0;  // of fields_
  Box3 box_;
  std::vector<std::int32_t> difference_;
  HaloBlock difference_block_;
};

}  // namespace voxweld
