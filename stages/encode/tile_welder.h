// Numbers the vertices of a mesh whose tiles come one after the other, without holding it.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <vector>

#include "storage/types/lattice_box.h"
#include "storage/types/tile_mesh.h"

namespace voxweld {

// Calls its argument with each tile of a mesh, in Morton order: as often as it is called, and with
// the same tiles each time.
using EachTile = std::function<void(const std::function<void(const TileMesh&)>&)>;

// Vertices are numbered by first use, as MeshAccumulator numbers them. What is kept of the tiles that
// have passed is a list of the vertices that later ones may use too: 32 bytes for each of those that
// are not surrounded by the tile's triangles (between labels: for all), mostly one in a hundred.
// Where two sheets touch in a single vertex and each lies in a tile of its own, it is two vertices.
class TileWelder {
 public:
  // Makes numbers and fresh() those of this tile. InputError where a vertex has other coordinates
  // than in a tile before, or the tile lies on another lattice.
  void add(const TileMesh& tile);

  // Of the tile's vertices, by their place in it.
  std::span<const std::uint64_t> numbers() const { return numbers_; }
  // Places of those that no tile before has used, in the order of their numbers.
  std::span<const std::uint32_t> fresh() const { return fresh_; }
  std::uint64_t vertices() const { return vertices_; }  // so far
  std::uint64_t triangles() const { return triangles_; }
  std::uint64_t kept() const;  // vertices in the lists

  // What is kept of a tile of so many vertices, for all but the most crumpled surfaces.
  static std::uint64_t kept_bytes(std::uint64_t vertices, bool between_labels);

 private:
  struct Kept {
    VertexId id;
    std::uint64_t number;
    LatticePoint at;
  };
  // What is kept of one tile.
  struct Border {
    LatticeBox box;
    std::vector<Kept> vertices;  // by id
  };
  void check_lattice(const TileMesh& tile);
  void find_open(const TileMesh& tile);
  // None where no tile before has the vertex. near: borders that meet the tile's box.
  const Kept* find(const TileMesh& tile, std::uint32_t v,
                   const std::vector<const Border*>& near) const;
  void keep(const TileMesh& tile, const LatticeBox& box);

  static constexpr std::uint64_t none = std::numeric_limits<std::uint64_t>::max();
  OutputLattice lattice_;
  std::vector<Border> borders_;
  std::vector<std::uint64_t> turns_;  // of each vertex: 0 where triangles surround it
  std::vector<std::uint64_t> numbers_;
  std::vector<std::uint32_t> fresh_;
  std::uint64_t vertices_ = 0, triangles_ = 0;
};

}  // namespace voxweld
