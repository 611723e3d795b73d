// Pieces of blocks put together to pieces of the volume, layer of blocks by layer along z. Held are
// those of the present layer that reach a face between blocks, and the face to the next layer.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <span>
#include <vector>

#include "stages/filter/block_pieces.h"

namespace voxweld {

// What became of a layer's nodes. A node is a piece of one of its blocks that reaches a face inside
// the volume; before these come the groups of the layer before that go on in this one, in their
// order. Nodes that hang together by now are a group; groups are in order of their first nodes.
struct JoinedLayer {
  static constexpr std::uint32_t complete = ~std::uint32_t{0};
  std::uint32_t carried = 0;          // nodes that are groups of the layer before
  std::vector<std::uint32_t> groups;  // of each node
  std::vector<std::uint32_t> next;    // of each group: its node of the next layer, or `complete`
};

class PieceJoin {
 public:
  explicit PieceJoin(Index3 blocks);  // blocks a side

  // The next block, x fastest, then y, then z. nodes: those of its pieces that reach a face inside
  // the volume. faces: the pieces on them are numbers of nodes.
  // Precondition: the layer has at most most_nodes with them.
  void add(std::span<const PieceFacts> nodes, BlockFaces&& faces);
  // After each layer's last block. Tells of the groups that are complete, ascending.
  JoinedLayer end_layer(const std::function<void(std::uint32_t, const PieceFacts&)>& complete);

  static constexpr std::uint64_t most_nodes = JoinedLayer::complete - 1;
  std::uint64_t nodes() const { return parent_.size(); }
  // What it holds, and what ending the layer would take besides.
  std::uint64_t bytes() const { return nodes() * node_bytes + face_bytes_; }

 private:
  // A parent, which grows to twice that; facts here and those that are carried; a group; its next.
  static constexpr std::uint64_t node_bytes = 5 * sizeof(std::uint32_t) + 2 * sizeof(PieceFacts);

  void join(const FaceRuns& a, const FaceRuns& b);
  void unite(std::uint32_t a, std::uint32_t b);
  std::uint32_t root(std::uint32_t node);
  void keep(FaceRuns& place, FaceRuns&& face);

  Index3 blocks_;
  Index3 at_;  // the next block
  std::vector<std::uint32_t> parent_;
  std::deque<PieceFacts> facts_;  // whole of roots only; a deque grows in place
  std::uint32_t carried_ = 0;
  FaceRuns before_x_;               // of the block before
  std::vector<FaceRuns> before_y_;  // of the row of blocks before, from here on; of this one so far
  std::vector<FaceRuns> before_z_;  // of the layer of blocks before, the same
  std::uint64_t face_bytes_ = 0;
};

}  // namespace voxweld
