#include "stages/build/hermite.h"

#include <algorithm>

#include "stages/build/edge_batch.h"
#include "stages/build/label_edge.h"
#include "stages/build/label_field.h"
#include "stages/build/solid_edge.h"

namespace voxweld {
namespace {

// Word w of a sign row with x = 0 in bit 0.
std::uint64_t from_zero(const std::uint64_t* row, std::size_t w) {
  return row[w] >> 1 | row[w + 1] << 63;
}

// Outward of what the edit leaves.
HermiteEdge edge_of_edit(const Edit& edit, const VolumeFrame& frame, int axis, Index3 s,
                         bool low_in_solid) {
  const HermiteEdge edge = edge_of_solid(edit.solid, frame, axis, s, low_in_solid);
  return edit.op == EditOp::subtract ? reversed(edge) : edge;
}

// Both surfaces cross the edge, both in the same direction: of a union the one further out is the
// surface, of an intersection the one further in.
const HermiteEdge& surface_of(EditOp op, bool low_inside, const HermiteEdge& before,
                              const HermiteEdge& solid) {
  const bool takes_higher = (op == EditOp::add) == low_inside;
  const bool solid_wins = takes_higher ? solid.t > before.t : solid.t < before.t;
  return solid_wins ? solid : before;
}

}  // namespace

template <class F>
void HermiteEdges::each_row(const F& f) const {
  for (int axis = 0; axis < 3; ++axis)
    for (auto z = static_cast<int>(window_.lo.z); z < window_.hi.z; ++z)
      for (auto y = static_cast<int>(window_.lo.y); y < window_.hi.y; ++y) f(axis, y, z);
}

void HermiteEdges::find_rows(const SignGrid& signs, int side, const Box3& where) {
  points_ = static_cast<std::size_t>(side) + 1;
  row_words_ = (points_ + 63) / 64;
  window_ = intersect(where, Box3{{}, splat(side + 1)});
  bits_.resize(3 * points_ * points_ * row_words_);
  each_row([&](int axis, int y, int z) {
    for (std::size_t w = 0; w < row_words_; ++w) {
      // x = side in this word, or past it.
      const int last = std::max(side - static_cast<int>(w) * 64, 0);
      const std::uint64_t points = last >= 63 ? ~std::uint64_t{0} : (std::uint64_t{2} << last) - 1;
      const std::uint64_t starts = last >= 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << last) - 1;
      const std::uint64_t* row = signs.row(y, z);
      const std::uint64_t here = from_zero(row, w);
      std::uint64_t bits = 0;
      if (axis == 0)
        bits = (here ^ (row[w] >> 2 | row[w + 1] << 62)) & starts;
      else if (axis == 1 && y < side)
        bits = (here ^ from_zero(signs.row(y + 1, z), w)) & points;
      else if (axis == 2 && z < side)
        bits = (here ^ from_zero(signs.row(y, z + 1), w)) & points;
      bits_[word_of(axis, static_cast<int>(w) * 64, y, z)] = bits;
    }
  });
  count_rows();
}

void HermiteEdges::count_rows() {
  first_.resize(bits_.size());
  std::uint32_t count = 0;
  each_row([&](int axis, int y, int z) {
    for (std::size_t w = 0; w < row_words_; ++w) {
      const std::size_t at = word_of(axis, static_cast<int>(w) * 64, y, z);
      first_[at] = count;
      count += static_cast<std::uint32_t>(std::popcount(bits_[at]));
    }
  });
  edges_.resize(count);
}

void HermiteEdges::find(const LabelGrid& labels) {
  const int side = labels.side();
  points_ = static_cast<std::size_t>(side) + 1;
  row_words_ = (points_ + 63) / 64;
  window_ = {{}, splat(side + 1)};
  bits_.assign(3 * points_ * points_ * row_words_, 0);
  const auto set = [&](int axis, int x, int y, int z, bool crosses) {
    bits_[word_of(axis, x, y, z)] |= std::uint64_t{crosses} << (x & 63);
  };
  for (int z = 0; z <= side; ++z)
    for (int y = 0; y <= side; ++y) {
      const std::uint32_t* row = labels.row(y, z);
      for (int x = 0; x < side; ++x) set(0, x, y, z, row[x] != row[x + 1]);
      const std::uint32_t* next_y = y < side ? labels.row(y + 1, z) : row;
      for (int x = 0; x <= side; ++x) set(1, x, y, z, row[x] != next_y[x]);
      const std::uint32_t* next_z = z < side ? labels.row(y, z + 1) : row;
      for (int x = 0; x <= side; ++x) set(2, x, y, z, row[x] != next_z[x]);
    }
  count_rows();
}

// f(number, axis, x, y, z) of every crossing edge, in the order they are kept.
template <class F>
void HermiteEdges::each_edge(const F& f) const {
  std::size_t next = 0;
  each_row([&](int axis, int y, int z) {
    for (std::size_t w = 0; w < row_words_; ++w)
      for (std::uint64_t rest = bits_[word_of(axis, static_cast<int>(w) * 64, y, z)]; rest != 0;
           rest &= rest - 1)
        f(next++, axis, static_cast<int>(w) * 64 + std::countr_zero(rest), y, z);
  });
}

template <class F>
void HermiteEdges::fill_edges(const F& edge_of) {
  each_edge(
      [&](std::size_t i, int axis, int x, int y, int z) { edges_[i] = edge_of(axis, x, y, z); });
}

void HermiteEdges::compute(const HaloBlock& block, Index3 brick, int side, const SignGrid& signs,
                           const Box3& where, const ContourParameters& parameters) {
  find_rows(signs, side, where);
  dispatch_sample_type(block.type, [&](auto tag) {
    using T = typename decltype(tag)::type;
    const EdgeEstimator<T> estimator(block, parameters);
    if constexpr (has_edge_kernel<T>) {
      if (parameters.surface.gradient == Gradient::subcell) {
        EdgeBatch<T> batch(block, parameters, estimator, edges_);
        each_edge([&](std::size_t i, int axis, int x, int y, int z) {
          batch.add(i, axis, brick + Index3{x, y, z} - splat(1), signs.inside(x, y, z));
        });
        return batch.flush();
      }
    }
    fill_edges([&](int axis, int x, int y, int z) {
      return estimator.edge(axis, brick + Index3{x, y, z} - splat(1), signs.inside(x, y, z));
    });
  });
}

void HermiteEdges::compute_label(const HaloBlock& field, Index3 brick, int side,
                                 const SignGrid& signs, const Box3& where, Vec3 spacing) {
  find_rows(signs, side, where);
  constexpr double middle = LabelField::full / 2.0;
  const LabelEdgeEstimator estimator(field, spacing, {middle, middle});
  fill_edges([&](int axis, int x, int y, int z) {
    return estimator.edge(axis, brick + Index3{x, y, z} - splat(1), signs.inside(x, y, z));
  });
}

void HermiteEdges::compute(const Edit& edit, const VolumeFrame& frame, Index3 brick, int side,
                           const SignGrid& signs, const SignGrid& solid,
                           const HermiteEdges& before) {
  find_rows(signs, side, Box3{{}, splat(side + 1)});
  fill_edges([&](int axis, int x, int y, int z) {
    const Index3 s = brick + Index3{x, y, z} - splat(1);
    const bool low_inside = signs.inside(x, y, z);
    if (s[axis] < 0 || s[axis] + 1 >= frame.size[axis]) return edge_of_middle(axis, low_inside);
    const int dx = axis == 0, dy = axis == 1, dz = axis == 2;
    const bool low_in_solid = solid.inside(x, y, z);
    const bool of_solid = low_in_solid != solid.inside(x + dx, y + dy, z + dz);
    if (!of_solid) return before.at(axis, x, y, z);
    const HermiteEdge own = edge_of_edit(edit, frame, axis, s, low_in_solid);
    if (!before.has(axis, x, y, z)) return own;
    return surface_of(edit.op, low_inside, before.at(axis, x, y, z), own);
  });
}

void HermiteEdges::unite(int side, const SignGrid& signs, const HermiteEdges& a,
                         const HermiteEdges& b) {
  find_rows(signs, side, Box3{{}, splat(side + 1)});
  fill_edges([&](int axis, int x, int y, int z) {
    if (!a.has(axis, x, y, z)) return b.at(axis, x, y, z);
    if (!b.has(axis, x, y, z)) return a.at(axis, x, y, z);
    return surface_of(EditOp::add, signs.inside(x, y, z), a.at(axis, x, y, z), b.at(axis, x, y, z));
  });
}

}  // namespace voxweld
