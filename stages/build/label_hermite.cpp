#include "stages/build/label_hermite.h"

#include <algorithm>

#include "stages/build/label_edge.h"

namespace voxweld {
namespace {

// Lattice points a side that are worked on together: so many fields of labels are held at once as
// there are labels in them.
constexpr int block_side = 8;

}  // namespace

void LabelHermite::find_edges(const LabelGrid& labels, int x0, int y0, int z0) {
  edges_.clear();
  const int side = labels.side();
  const auto end = [&](int from) { return std::min(from + block_side, side + 1); };
  for (int z = z0; z < end(z0); ++z)
    for (int y = y0; y < end(y0); ++y)
      for (int x = x0; x < end(x0); ++x) {
        const std::uint32_t here = labels.at(x, y, z);
        const auto add = [&](int axis, std::uint32_t next) {
          if (here != next) edges_.push_back({here, next, axis, x, y, z});
        };
        if (x < side) add(0, labels.at(x + 1, y, z));
        if (y < side) add(1, labels.at(x, y + 1, z));
        if (z < side) add(2, labels.at(x, y, z + 1));
      }
}

const HaloBlock& LabelHermite::field_of(const HaloBlock& samples, std::uint32_t label) {
  for (std::size_t i = 0; i < used_; ++i)
    if (fields_[i].label == label) return fields_[i].block;
  if (used_ == fields_.size()) fields_.emplace_back();
  Field& field = fields_[used_++];
  field.label = label;
  field.block = field.filter.filter(samples, label, box_);
  return field.block;
}

void LabelHermite::subtract(std::uint32_t a, std::uint32_t b) {
  const auto find = [&](std::uint32_t label) {
    std::size_t at = 0;
    while (fields_[at].label != label) ++at;
    return reinterpret_cast<const std::int32_t*>(fields_[at].block.data);
  };
  const std::int32_t *of_a = find(a), *of_b = find(b);
  difference_.resize(static_cast<std::size_t>(box_.count()));
  for (std::size_t i = 0; i < difference_.size(); ++i) difference_[i] = of_a[i] - of_b[i];
}

void LabelHermite::compute_block(const HaloBlock& samples, Index3 brick, Index3 first, int side,
                                 Vec3 spacing, HermiteEdges& out) {
  // Lattice point u is sample u - 1; the gradients at both ends of the edges reach further.
  const Index3 last = min(first + splat(block_side), splat(side));
  box_ = intersect({brick + first - splat(1 + gradient_halo), brick + last + splat(gradient_halo)},
                   Box3{{}, samples.size});
  std::stable_sort(edges_.begin(), edges_.end(),
                   [](const Edge& a, const Edge& b) { return a.pair() < b.pair(); });
  used_ = 0;
  for (std::size_t i = 0; i < edges_.size();) {
    const std::uint64_t pair = edges_[i].pair();
    const auto a = static_cast<std::uint32_t>(pair >> 32), b = static_cast<std::uint32_t>(pair);
    bool ready = false;
    for (; i < edges_.size() && edges_[i].pair() == pair; ++i) {
      const Edge& edge = edges_[i];
      HermiteEdge& datum = out.datum(edge.axis, edge.x, edge.y, edge.z);
      const Index3 s = brick + Index3{edge.x, edge.y, edge.z} - splat(1);
      Index3 next = s;
      ++next[edge.axis];
      if (!box_.contains(s) || !box_.contains(next)) {
        datum = edge_of_middle(edge.axis, edge.low == a);
        continue;
      }
      if (!ready) {
        difference_block_ = field_of(samples, a);
        field_of(samples, b);
        subtract(a, b);
        difference_block_.data = reinterpret_cast<const std::byte*>(difference_.data());
        ready = true;
      }
      datum = LabelEdgeEstimator(difference_block_, spacing, {0, LabelField::full})
                  .edge(edge.axis, s, edge.low == a);
    }
  }
}

void LabelHermite::compute(const HaloBlock& samples, Index3 brick, const LabelGrid& labels,
                           Vec3 spacing, HermiteEdges& out) {
  out.find(labels);
  for (int z = 0; z <= labels.side(); z += block_side)
    for (int y = 0; y <= labels.side(); y += block_side)
      for (int x = 0; x <= labels.side(); x += block_side) {
        find_edges(labels, x, y, z);
        if (!edges_.empty()) compute_block(samples, brick, {x, y, z}, labels.side(), spacing, out);
      }
}

std::uint64_t LabelHermite::memory_bytes() {
  constexpr std::uint64_t points = block_side + 1,
                          field = points + std::size_t{2} * (gradient_halo + LabelField::reach);
  return points * points * points * (2 * field * field * field * sizeof(std::int32_t) + 128);
}

}  // namespace voxweld
