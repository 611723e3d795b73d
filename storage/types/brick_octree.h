// What build makes of one brick: the simplified octree's vertices, the polygons the brick owns, the
// ghost layer its lower neighbours need, and the record by which merge goes on collapsing above it.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "storage/types/brick_levels.h"
#include "storage/types/leaf_vertex.h"
#include "storage/types/material.h"
#include "storage/types/morton.h"
#include "storage/types/node_record.h"
#include "storage/types/tile_mesh.h"

namespace voxweld {

// Bricks are 16 .. 256 cells a side, so a cell inside one has a 24-bit Morton code.
inline constexpr int min_brick_level = 4;
inline constexpr int max_brick_level = 8;

// Counts are kept, and tiles cut, in blocks of this side whatever the brick size.
inline constexpr int block_level = 4;

// A corner of a polygon: a vertex of this brick, or a cell of one of the seven upper neighbours
// together with the edge of that cell the polygon stands for (which picks the sheet).
struct CornerRef {
  std::uint32_t bits = 0;
  static constexpr CornerRef local(std::uint32_t vertex) { return {vertex}; }
  static constexpr CornerRef foreign(int direction, std::uint32_t code, int edge) {
    return {0x80000000u | static_cast<std::uint32_t>(direction) << 28 |
            static_cast<std::uint32_t>(edge) << 24 | code};
  }
  constexpr bool is_foreign() const { return (bits >> 31) != 0; }
  constexpr std::uint32_t vertex() const { return bits; }
  constexpr int direction() const {
    return static_cast<int>(bits >> 28 & 7);
  }  // bit a: +1 on axis a
  constexpr int edge() const { return static_cast<int>(bits >> 24 & 15); }
  constexpr std::uint32_t code() const { return bits & 0xffffff; }
  friend constexpr bool operator==(CornerRef, CornerRef) = default;
};
using PolygonRefs = std::array<CornerRef, 4>;  // counter-clockwise seen from outside

// One 16^3 block of the brick, in Morton order.
struct BlockCount {
  std::uint32_t polygon_end = 0;  // its polygons end here, and begin where the block before ends
  std::uint32_t vertices = 0;     // of leaves whose lowest cell lies in the block
};

// One that owns a polygon or a vertex.
struct FilledBlock {
  std::uint32_t block = 0;  // in Morton order
  std::uint32_t vertices = 0;
  std::uint32_t polygons = 0;
};
// Of a brick's blocks, in Morton order.
inline std::vector<FilledBlock> filled_blocks(std::span<const BlockCount> blocks) {
  std::vector<FilledBlock> filled;
  std::uint32_t begin = 0;
  for (std::uint32_t b = 0; b < blocks.size(); ++b) {
    const BlockCount& block = blocks[b];
    if (block.vertices != 0 || block.polygon_end != begin)
      filled.push_back({b, block.vertices, block.polygon_end - begin});
    begin = block.polygon_end;
  }
  return filled;
}

// An active finest cell of the lowest layer on x, y or z.
struct GhostCell {
  std::uint32_t code_signs = 0;  // Morton code (24 bits) | sign byte << 24
  std::uint32_t first_joined =
      0;  // first of its sheets in GhostLayer::vertices | joined face << 31
  constexpr std::uint32_t code() const { return code_signs & 0xffffff; }
  constexpr int signs() const { return static_cast<int>(code_signs >> 24); }
  constexpr std::uint32_t first() const { return first_joined & 0x7fffffff; }
  constexpr bool joined() const { return first_joined >> 31 != 0; }
  constexpr GhostCell with_first(std::uint32_t first) const {
    return {code_signs, first | (first_joined & 0x80000000u)};
  }
};
struct GhostVertex {
  std::uint32_t brick_vertex = 0;  // its index in BrickOctree::vertices
  LeafVertex vertex;
};
struct GhostLayer {
  std::vector<GhostCell> cells;  // ascending code
  std::vector<GhostVertex> vertices;
  // Between labels a sign byte does not tell the sheets: beside `cells`, that of edge e in the bits
  // 2 e and 2 e + 1. Else empty.
  std::vector<std::uint32_t> sheets_of_edges;
  // topology = "manifold" only. Of a cell of several sheets first() is a place here, and from there
  // on the vertex of each of them; of other cells it is a vertex.
  std::vector<std::uint32_t> apart;
  std::vector<std::uint8_t> roots;  // beside `vertices`, as BrickOctree has them
};

// What an octree node is to its parent.
enum class NodeState : std::uint32_t {
  outside,  // homogeneous
  inside,   // homogeneous
  leaf,     // one vertex; the record holds what collapsing further needs
  split,    // stays as it is
};
struct RootRecord {
  NodeState state = NodeState::outside;
  std::uint32_t corner_signs = 0;  // bit i: corner i (x = i & 1, y = i >> 1 & 1, z = i >> 2) inside
  Qef qef;
  NormalClusters clusters;
  LeafVertex vertex;
  float residual = 0;  // root mean square distance reached (metric rms) or its sum's root (sum)
  std::uint32_t unused = 0;  // or there were padding here, whose bytes are not told
  // labels.mode = "shared" only, and then in place of the signs: the corners' materials; those of a
  // homogeneous node are all its own, and it is `inside` whatever that is but `exterior`.
  std::array<Material, 8> corners{};
};

// Figures that add up over bricks (and take the maximum where they are one).
struct BrickCounts {
  std::uint64_t active_cells = 0;
  std::uint64_t crossing_edges = 0;  // owned by the brick
  LeafCounts by_level;
  std::uint64_t vertices = 0;
};
inline void add(BrickCounts& sum, const BrickCounts& part) {
  sum.active_cells += part.active_cells;
  sum.crossing_edges += part.crossing_edges;
  add(sum.by_level, part.by_level);
  sum.vertices += part.vertices;
}

struct BrickOctree {
  // By node from the top down, these in Morton order, then by first cell and sheet.
  std::vector<LeafVertex> vertices;
  // topology = "manifold" only: of each vertex the cluster of `record` that it is of, or no_root.
  static constexpr std::uint8_t no_root = 255;
  std::vector<std::uint8_t> roots;
  NodeRecord record;
  BrickLevels levels;
  std::vector<PolygonRefs> polygons;  // by owner cell in Morton order, then axis
  // topology = "free" only, beside polygons: bit l set when the polygon stands if its smallest leaf
  // has level l.
  std::vector<std::uint8_t> emit_levels;
  // labels.mode = "shared" only: what is on either side of the polygons, as a list, and each
  // polygon's place in it.
  std::vector<MaterialPair> pairs;
  std::vector<std::uint32_t> polygon_pairs;
  std::vector<BlockCount> blocks;
  GhostLayer ghost;
  RootRecord root;
  BrickCounts counts;
};

}  // namespace voxweld
