// Which triangles meet at which edges and vertices of an indexed mesh.
//
// Half-edge h = 3 t + k runs from corner k of triangle t to corner k + 1. The triangles around a
// vertex v form fans: runs of triangles, counter-clockwise seen from outside, each joined to the
// next by an edge at v. An interior vertex of a 2-manifold has one closed fan; a vertex on a simple
// boundary one open fan, from neighbour `from` to neighbour `to`.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "stages/encode/lattice_mesh.h"
#include "storage/types/tile_mesh.h"

namespace voxweld {

struct Fan {
  bool closed = false;
  std::uint32_t from = 0, to = 0;         // neighbour vertices; of open fans only
  std::vector<std::uint32_t> half_edges;  // outgoing from the vertex, in order
};

class Adjacency {
 public:
  // The reverse half-edge, where there is exactly one in each direction; else one of these.
  static constexpr std::uint32_t boundary = std::numeric_limits<std::uint32_t>::max();
  static constexpr std::uint32_t complex = boundary - 1;

  // Keeps a reference to `triangles`. Memory: 24 bytes a triangle and 5 a vertex.
  // Precondition: fewer than 2^32 / 3 - 1 triangles.
  Adjacency(std::span<const Triangle> triangles, std::size_t vertices);
  Adjacency(std::vector<Triangle>&&, std::size_t) = delete;

  std::uint32_t from(std::uint32_t h) const { return triangles_[h / 3][h % 3]; }
  std::uint32_t to(std::uint32_t h) const { return from(next(h)); }
  std::uint32_t opposite(std::uint32_t h) const { return opposite_[h]; }
  std::span<const std::uint32_t> outgoing(std::uint32_t v) const {
    return std::span(half_edges_).subspan(first_[v], first_[v + 1] - first_[v]);
  }
  // All fans of v, each outgoing half-edge in exactly one. Complex edges end fans as boundaries do.
  // `out` is reused.
  void fans(std::uint32_t v, std::vector<Fan>& out) const;

 private:
  static std::uint32_t next(std::uint32_t h) { return h % 3 == 2 ? h - 2 : h + 1; }
  static std::uint32_t previous(std::uint32_t h) { return h % 3 == 0 ? h + 2 : h - 1; }
  void sort_by_origin(std::size_t vertices);
  void match();
  Fan walk(std::uint32_t start) const;

  std::span<const Triangle> triangles_;
  std::vector<std::uint32_t> first_, half_edges_, opposite_;
};

// Copies a vertex once for each fan but its first, so that no two fans share a vertex (DESIGN:
// geometry, open borders). Copies go to the end, in order of vertex, then of the fans' lowest
// triangle; they keep id, position and normals. Returns the number of copies.
std::uint64_t split_fans(TileMesh& mesh);
std::uint64_t split_fans(LatticeMesh& mesh);  // then positions are no longer distinct

}  // namespace voxweld
