// The crossing and normal of one lattice edge between labels, from the filtered indicator of one
// label or from the difference of those of two (label_field.h).
//
// A filter of variance v changes a field by v/2 of its second derivatives (it is a step of the heat
// equation), which pulls curved surfaces to the side they bend around and lets thin ones fade. So
// crossings are sought in the field less half its second differences: that undoes what the filter
// does to all but the stairs, up to the fourth order. Normals are the filtered field's gradients,
// which the stairs show least in.
//
// Where even that field says that a sample is not of its own label, the label is thinner than the
// filter can tell, and the crossing goes by that much to the middle of the edge, the best guess
// from the labels alone: what is one sample thick stays so. On solids made voxels, with thin ones
// among them, the distance to the true surface and the enclosed volume were best with both
// (tests/paper/paper_labels.cpp).
#pragma once

#include <algorithm>
#include <cstdint>

#include "stages/build/edge_estimator.h"

namespace voxweld {

// Of the estimate: raised with every change of what comes out.
inline constexpr std::uint32_t label_estimate_version = 2;

// The field's value on the surface, and how far from that it is where all around is one label.
struct LabelLevel {
  double surface = 0, range = 1;
};

class LabelEdgeEstimator : private EdgeEstimator<std::int32_t> {
 public:
  // field: of i32, higher on the inside, at all samples next to the ends of edges asked for.
  LabelEdgeEstimator(const HaloBlock& field, Vec3 spacing, LabelLevel level)
      : EdgeEstimator(field, parameters(spacing)), level_(level) {}

  // The edge along `axis` from sample `s` to the next; low_inside: whether its low end is.
  HermiteEdge edge(int axis, Index3 s, bool low_inside) const {
    if (s[axis] < 0 || s[axis] + 1 >= size()[axis]) return edge_of_middle(axis, low_inside);
    Index3 next = s;
    ++next[axis];
    const End low = end(s), high = end(next);
    const double rise = high.field - low.field;
    // Towards the inside it can only fall where that is thinner than the filter.
    if (low_inside ? rise > 0 : rise < 0) return edge_of_middle(axis, low_inside);
    return crossing(axis, low_inside, low, high);
  }

 private:
  struct End {
    const std::int32_t* at;
    Index3 sample;
    double field;  // above the surface's level
    double sharp;  // twice the field less half its second differences, above the surface's level
  };

  static ContourParameters parameters(Vec3 spacing) {
    ContourParameters p;
    p.spacing = spacing;
    p.surface.gradient = Gradient::central;
    return p;
  }

  End end(Index3 s) const {
    const std::int32_t* p = sample(s);
    std::int64_t second = 0;
    for (int a = 0; a < 3; ++a)  // the volume's border goes on as it is
      if (s[a] > 0 && s[a] + 1 < size()[a])
        second += std::int64_t{p[stride(a)]} + p[-stride(a)] - 2 * std::int64_t{*p};
    const double field = static_cast<double>(*p) - level_.surface;
    return {p, s, field, 2 * field - static_cast<double>(second)};
  }

  HermiteEdge crossing(int axis, bool low_inside, const End& low, const End& high) const {
    double t = low.sharp / (low.sharp - high.sharp);
    const bool falls = low_inside ? low.sharp > high.sharp : low.sharp < high.sharp;
    t = falls ? std::clamp(t, lowest_crossing, highest_crossing) : 0.5;
    // How far the ends are on their own sides, the worse of them; gone at a fifth of the range.
    const double own =
        (low_inside ? std::min(low.field, -high.field) : std::min(-low.field, high.field)) /
        level_.range;
    const double trust = std::clamp(1 + 5 * own, 0.0, 1.0);
    t = 0.5 + trust * (t - 0.5);
    HermiteEdge result = edge_of_middle(axis, low_inside);
    result.t = static_cast<float>(t);
    const Vec3 g = gradient(low.at, low.sample) * (1 - t) + gradient(high.at, high.sample) * t;
    const double length = std::sqrt(dot(g, g));
    if (length > 0)
      for (int a = 0; a < 3; ++a)
        result.normal[static_cast<std::size_t>(a)] = static_cast<float>(-g[a] / length);
    return result;
  }

  LabelLevel level_;
};

}  // namespace voxweld
