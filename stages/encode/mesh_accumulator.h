// Joins the tiles of a run, given in order, into one mesh.
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "storage/types/index_table.h"
#include "storage/types/tile_mesh.h"

namespace voxweld {

class MeshAccumulator {
 public:
  MeshAccumulator() = default;
  MeshAccumulator(const MeshAccumulator&) = delete;
  MeshAccumulator& operator=(const MeshAccumulator&) = delete;

  // Appends a tile's triangles; vertices are joined by id and numbered by first use. So the result
  // depends on the sequence of triangles alone, not on where it is cut into tiles: tiles are to
  // come in Morton order. InputError when a tile lies on another lattice, when a vertex has other
  // coordinates than in a tile before, when only some tiles have normals, or past 2^32 - 1
  // vertices.
  void append(const TileMesh& tile);

  // The mesh so far; its `tile` is the first one's. The accumulator is empty afterwards.
  TileMesh take();

 private:
  std::uint32_t add_vertex(const TileMesh& tile, std::uint32_t v);
  void check(const TileMesh& tile) const;

  TileMesh mesh_;
  VertexTable table_{VertexIdHash{&mesh_.ids}};
  void append_pairs(const TileMesh& tile);
  void sort_pairs();

  std::map<MaterialPair, std::uint32_t> pairs_;  // place in mesh_.pairs, as first met
  std::vector<std::uint32_t> merged_;  // of the current tile's vertices, kept for its memory
};

// What an accumulator of this many vertices and triangles takes at most, growth of its arrays
// included; encode_memory_bytes comes on top when the result is encoded.
std::uint64_t accumulator_memory_bytes(std::uint64_t vertices, std::uint64_t triangles,
                                       bool normals);

}  // namespace voxweld
