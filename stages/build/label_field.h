// One label of a label volume as a field whose level set is that label's surface.
//
// Which samples are inside is exact: those equal to the label. Where between two samples the
// surface passes labels do not say, and midpoints with axis normals look like stairs; so crossings
// and normals are those of the label's indicator after a binomial filter, (1, 4, 6, 4, 1) / 16
// along each axis: about a Gaussian of one sample's variance, whose gradient is the usual estimate
// of a binary surface's normal (Hoehne and Bernstein, "Shading 3D-Images from CT Using Gray-Level
// Gradients", 1986, after smoothing). label_edge.h takes crossings and normals from it: on
// voxelised spheres, planes, tori and slabs that halves the distance to the true surface and takes
// the mean normal error from 45 to 3 degrees (tests/stages/label_field_test.cpp).
#pragma once

#include <cstdint>
#include <vector>

#include "stages/contouring/parameters.h"
#include "storage/types/halo_block.h"

namespace voxweld {

class LabelField {
 public:
  // Samples the filter reaches beyond those it is asked for.
  static constexpr int reach = label_halo;
  // Of the field, where all samples in reach are inside: 16^3.
  static constexpr std::int32_t full = 4096;

  // The filtered indicator at `box` as a block of i32, which lives until the next call. Beyond the
  // volume's border its outermost samples go on.
  // Preconditions: block holds integers, at `box` and `reach` around it as far as the volume goes;
  // box lies in the volume.
  HaloBlock filter(const HaloBlock& block, std::uint64_t label, const Box3& box);

 private:
  void fill_indicator(const HaloBlock& block, std::uint64_t label, const Box3& box);
  void filter_along(int axis, Index3 size);

  std::vector<std::int32_t> field_, rows_;
};

// value == label, in the sample's own type: negative labels are not reached.
template <class T>
struct LabelTest {
  bool never = false;
  T value = 0;
  LabelTest(std::uint64_t label) : value(static_cast<T>(label)) {
    never = value < 0 || static_cast<std::uint64_t>(value) != label;
  }
  bool operator()(T sample) const { return !never && sample == value; }
};

}  // namespace voxweld
