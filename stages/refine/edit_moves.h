// What can be done at a place of a mesh: a vertex moves, an edge flips, an edge collapses.
#pragma once

#include <optional>

#include "stages/refine/edit_mesh.h"

namespace voxweld {

// Of an edge that may collapse.
struct EdgeEnds {
  std::uint32_t gone, keep;
  bool stays;  // the one that is kept stays where it is
};

// Fills changes for EditMesh::apply. Of a change the i-th of the new triangles comes from the i-th of
// the old ones; a collapse has two more old ones. All return false where the change would spoil the
// mesh: its topology, or a triangle of no area. They do not look at the shape otherwise.
class EditMoves {
 public:
  // Triangles around a vertex after a collapse, and where sheets meet.
  static constexpr std::size_t most_around = 24, most_where_sheets_meet = 48;

  explicit EditMoves(const EditMesh& mesh) : mesh_(mesh), marks_(mesh.vertices()) {}

  // v: free. at: in the cube.
  bool move(std::uint32_t v, const LatticePoint& at, Change& out);
  // Which of two goes: to one of a higher kind, or to an anchor, the other one; else the one with the
  // higher id. Nothing where the edge may not collapse: what lies on a line where sheets meet goes
  // along it.
  std::optional<EdgeEnds> ends(std::uint32_t u, std::uint32_t v) const;
  // u goes to v, which then lies at `at`; both as `ends` has them.
  // The link condition (Dey, Edelsbrunner, Guha, Nekhayev, "Topology Preserving Edge Contraction",
  // 1999) is asked by `linked`, once for all places.
  bool linked(std::uint32_t u, std::uint32_t v);
  bool collapse(std::uint32_t u, std::uint32_t v, const LatticePoint& at, Change& out);
  // The edge between the corners k and k + 1 of a movable triangle, whose other triangle is so too.
  // Where sheets meet there is no such edge.
  bool flip(std::uint32_t triangle, std::size_t k, Change& out);

  // The vertices around v, ascending.
  void ring(std::uint32_t v, std::vector<std::uint32_t>& out) const;

 private:
  bool add(std::uint32_t triangle, const Corners& now, const LatticeTriangle& shape, Change& out);
  bool sheets_stay_apart(std::uint32_t u, std::uint32_t v) const;

  const EditMesh& mesh_;
  std::vector<std::uint32_t> star_u_, star_v_, common_;
  std::vector<std::uint32_t>
      marks_;  // of vertices: equal to mark_ where they are neighbours of one
  std::uint32_t mark_ = 0;
};

}  // namespace voxweld
