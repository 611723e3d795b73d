// Where the rim of a mesh has been: the places of its vertices that were collapsed, by the edge of the
// rim that is nearest now. Triangles know how far samples are from them, but not whether they reach
// beyond what was the rim.
#pragma once

#include <array>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "stages/refine/edit_mesh.h"

namespace voxweld {

class RimPlaces {
 public:
  explicit RimPlaces(const EditMesh& mesh) : mesh_(mesh) {}

  // Whether no place would be further from the rim than `most`, lattice steps, were `gone` to become
  // one with `keep`, at that place. Preconditions: an edge of the rim joins them; both are free or
  // anchors; gone is of kind rim; where keep is not, it stays where it is.
  bool keeps(std::uint32_t gone, std::uint32_t keep, const LatticePoint& at, double most);
  // That change is made now. Precondition: keeps() said yes to it, and was not asked since.
  void apply();

 private:
  struct Edge {
    std::uint32_t from = EditMesh::none, to = EditMesh::none;
    LatticePoint a{}, b{};
    std::vector<LatticePoint> places;
    bool is_there() const { return from != EditMesh::none && to != EditMesh::none; }
    std::uint64_t key() const { return std::uint64_t{from} << 32 | to; }
  };
  enum class Way : std::uint8_t { backwards, forwards };
  std::uint32_t neighbour(std::uint32_t v, Way way) const;
  void take(std::uint32_t from, std::uint32_t to);

  const EditMesh& mesh_;
  std::unordered_map<std::uint64_t, std::vector<LatticePoint>> places_;  // of each edge of the rim
  // Of the change at hand.
  std::vector<LatticePoint> taken_;
  std::vector<std::uint64_t> old_;
  std::array<Edge, 2> now_;
};

}  // namespace voxweld
