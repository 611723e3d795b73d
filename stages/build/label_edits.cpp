#include "stages/build/label_edits.h"

#include <algorithm>

#include "stages/build/solid_edge.h"

namespace voxweld {
namespace {

std::uint32_t at(const LabelGrid& labels, Index3 p) {
  return labels.at(static_cast<int>(p.x), static_cast<int>(p.y), static_cast<int>(p.z));
}
bool holds(const SignGrid& solid, Index3 p) {
  return solid.inside(static_cast<int>(p.x), static_cast<int>(p.y), static_cast<int>(p.z));
}

// Whether the edit decides the label of a point, by its side of the solid and its label before.
bool decides(EditOp op, bool in_solid, bool is_exterior) {
  if (op == EditOp::intersect) return !in_solid;
  return in_solid && !(op == EditOp::replace && is_exterior);
}

}  // namespace

void LabelEdits::give_labels(const Edit& edit, LabelGrid& labels) const {
  const std::uint32_t given = labels.number_of(edit.material), outside = labels.outside();
  for (int z = 0; z <= labels.side(); ++z)
    for (int y = 0; y <= labels.side(); ++y)
      for (int x = 0; x <= labels.side(); ++x) {
        const std::uint32_t label = labels.at(x, y, z);
        if (decides(edit.op, solid_.inside(x, y, z), label == outside)) labels.set(x, y, z, given);
      }
}

// Along the edge what the edit decides reaches from one end to the solid's surface, and there its
// surface is: but where that end had the label before, and had it further than that.
HermiteEdge LabelEdits::edge_after(const Edit& edit, const VolumeFrame& frame, Index3 brick,
                                   int axis, Index3 p, const LabelGrid& labels) const {
  Index3 q = p;
  ++q[axis];
  const std::uint32_t low = at(labels, p), high = at(labels, q);
  const std::uint32_t low_before = at(before_, p), high_before = at(before_, q);
  const Index3 s = brick + p - splat(1);
  if (s[axis] < 0 || s[axis] + 1 >= frame.size[axis]) return edge_of_middle(axis, low < high);
  const auto kept = [&] {
    const HermiteEdge& edge =
        edges_before_.at(axis, static_cast<int>(p.x), static_cast<int>(p.y), static_cast<int>(p.z));
    return (low < high) == (low_before < high_before) ? edge : reversed(edge);
  };
  const std::uint32_t outside = labels.outside();
  const bool low_in_solid = holds(solid_, p);
  const bool by_low = decides(edit.op, low_in_solid, low_before == outside),
             by_high = decides(edit.op, holds(solid_, q), high_before == outside);
  if (by_low == by_high || low_in_solid == holds(solid_, q)) return kept();
  HermiteEdge own = edge_of_solid(edit.solid, frame, axis, s, low_in_solid);
  if (low_in_solid != (low < high)) own = reversed(own);
  const bool had_it = by_low ? low_before == low : high_before == high;
  if (!had_it || low_before == high_before) return own;
  const HermiteEdge before = kept();
  const bool further = by_low ? before.t > own.t : before.t < own.t;
  return further ? before : own;
}

void LabelEdits::apply(const Edit& edit, const VolumeFrame& frame, Index3 brick, LabelGrid& labels,
                       HermiteEdges& edges) {
  const int side = labels.side();
  solid_.fill(edit.solid, frame, brick, side);
  before_ = labels;
  std::swap(edges, edges_before_);
  give_labels(edit, labels);
  edges.find(labels);
  for (int axis = 0; axis < 3; ++axis)
    for (int z = 0; z <= side; ++z)
      for (int y = 0; y <= side; ++y)
        for (int x = 0; x <= side; ++x)
          if (edges.has(axis, x, y, z))
            edges.datum(axis, x, y, z) = edge_after(edit, frame, brick, axis, {x, y, z}, labels);
}

}  // namespace voxweld
