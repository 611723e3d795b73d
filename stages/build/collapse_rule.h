// What the lattice points of a brick say of the nodes of its octree: which may collapse, and which of
// their edges cross the surface.
#pragma once

#include <array>
#include <cstdint>

namespace voxweld {

// Of a node of 2^3 cells: its edges that cross, along each axis. Bit x + 3 y + 9 z is the one from that
// of its 27 lattice points.
using NodeCrossings = std::array<std::uint32_t, 3>;
// All of its edges; how far the other end of each is, in bits.
inline constexpr NodeCrossings edges_of_node = {0x36db6db, 0x0fc7e3f, 0x003ffff};
inline constexpr std::array<int, 3> bits_along = {1, 3, 9};

class CollapseRule {
 public:
  virtual ~CollapseRule() = default;
  // The node of `side` cells at (x, y, z) relative to the brick; its children are leaves or
  // homogeneous.
  virtual bool allows(int x, int y, int z, int side) const = 0;
  // Of the node of two cells a side there.
  virtual NodeCrossings crossings(int x, int y, int z) const = 0;
};

}  // namespace voxweld
