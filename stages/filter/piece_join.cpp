#include "stages/filter/piece_join.h"

#include <algorithm>
#include <bit>
#include <utility>

namespace voxweld {
namespace {

std::uint64_t bytes_of(const FaceRuns& face) {
  return sizeof face + face.rows.capacity() * 8 + face.pieces.capacity() * 4;
}

constexpr std::uint64_t run_starts(std::uint64_t bits) {
  return bits & ~(bits << 1);
}
// Which run of the row, counted from 0, holds the bit.
constexpr std::size_t run_at(std::uint64_t starts, int bit) {
  return static_cast<std::size_t>(std::popcount(starts & ~std::uint64_t{0} >> (63 - bit)) - 1);
}

}  // namespace

PieceJoin::PieceJoin(Index3 blocks)
    : blocks_(blocks),
      before_y_(static_cast<std::size_t>(blocks.x)),
      before_z_(static_cast<std::size_t>(blocks.x * blocks.y)) {
  face_bytes_ = (before_y_.size() + before_z_.size() + 1) * sizeof(FaceRuns);
}

void PieceJoin::add(std::span<const PieceFacts> nodes, BlockFaces&& faces) {
  const auto base = static_cast<std::uint32_t>(parent_.size());
  for (std::uint32_t i = 0; i < nodes.size(); ++i) parent_.push_back(base + i);
  facts_.insert(facts_.end(), nodes.begin(), nodes.end());
  for (FaceRuns& face : faces)
    for (std::uint32_t& node : face.pieces) node += base;
  FaceRuns& before_y = before_y_[static_cast<std::size_t>(at_.x)];
  FaceRuns& before_z = before_z_[static_cast<std::size_t>(at_.x + blocks_.x * at_.y)];
  const std::array<FaceRuns*, 3> before{&before_x_, &before_y, &before_z};
  for (int axis = 0; axis < 3; ++axis) {
    FaceRuns& place = *before[static_cast<std::size_t>(axis)];
    join(place, faces[static_cast<std::size_t>(face_of(axis, false))]);
    keep(place, std::move(faces[static_cast<std::size_t>(face_of(axis, true))]));
  }
  if (++at_.x < blocks_.x) return;
  at_.x = 0;
  ++at_.y;
}

void PieceJoin::keep(FaceRuns& place, FaceRuns&& face) {
  face_bytes_ -= bytes_of(place);
  place = std::move(face);
  face_bytes_ += bytes_of(place);
}

// Both are seen in the same rows: where both have a bit their pieces are one.
void PieceJoin::join(const FaceRuns& a, const FaceRuns& b) {
  if (a.rows.empty() || b.rows.empty()) return;
  std::size_t a_first = 0, b_first = 0;
  std::pair<std::uint32_t, std::uint32_t> last{~0U, ~0U};
  for (std::size_t row = 0; row < a.rows.size(); ++row) {
    const std::uint64_t a_starts = run_starts(a.rows[row]), b_starts = run_starts(b.rows[row]);
    for (std::uint64_t left = run_starts(a.rows[row] & b.rows[row]); left != 0; left &= left - 1) {
      const int bit = std::countr_zero(left);
      const std::pair pair{a.pieces[a_first + run_at(a_starts, bit)],
                           b.pieces[b_first + run_at(b_starts, bit)]};
      if (pair != last) unite(pair.first, pair.second);
      last = pair;
    }
    a_first += static_cast<std::size_t>(std::popcount(a_starts));
    b_first += static_cast<std::size_t>(std::popcount(b_starts));
  }
}

void PieceJoin::unite(std::uint32_t a, std::uint32_t b) {
  a = root(a);
  b = root(b);
  if (a == b) return;
  if (b < a) std::swap(a, b);  // the first node stands for the group
  parent_[b] = a;
  facts_[a] = merge(facts_[a], facts_[b]);
}

std::uint32_t PieceJoin::root(std::uint32_t node) {
  while (parent_[node] != node) {
    parent_[node] = parent_[parent_[node]];
    node = parent_[node];
  }
  return node;
}

JoinedLayer PieceJoin::end_layer(
    const std::function<void(std::uint32_t, const PieceFacts&)>& complete) {
  JoinedLayer layer;
  layer.carried = carried_;
  layer.groups.resize(parent_.size());
  std::uint32_t count = 0;
  for (std::uint32_t node = 0; node < parent_.size(); ++node) {
    const std::uint32_t first = root(node);
    layer.groups[node] = first == node ? count++ : layer.groups[first];
  }
  layer.next.assign(count, JoinedLayer::complete);
  for (const FaceRuns& face : before_z_)
    for (const std::uint32_t node : face.pieces) layer.next[layer.groups[node]] = 0;
  std::deque<PieceFacts> carried;
  for (std::uint32_t node = 0, group = 0; node < parent_.size(); ++node) {
    if (parent_[node] != node) continue;
    if (layer.next[group] == JoinedLayer::complete) {
      complete(group, facts_[node]);
    } else {
      layer.next[group] = static_cast<std::uint32_t>(carried.size());
      carried.push_back(facts_[node]);
    }
    ++group;
  }
  for (FaceRuns& face : before_z_)
    for (std::uint32_t& node : face.pieces) node = layer.next[layer.groups[node]];
  facts_ = std::move(carried);
  carried_ = static_cast<std::uint32_t>(facts_.size());
  parent_.resize(carried_);
  for (std::uint32_t node = 0; node < carried_; ++node) parent_[node] = node;
  keep(before_x_, {});
  for (FaceRuns& face : before_y_) keep(face, {});
  at_ = {0, 0, at_.z + 1};
  return layer;
}

}  // namespace voxweld
