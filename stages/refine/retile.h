// Between the meshes of tiles, as stitch makes them and encode takes them, and what refine works on.
#pragma once

#include <vector>

#include "stages/refine/cube_lattice.h"
#include "storage/types/refine_mesh.h"
#include "storage/types/tile_mesh.h"
#include "storage/types/top_tree.h"

namespace voxweld {

// Of stitch: its triangles, the corner with the lowest id first. Corner normals are left out: they
// follow from the vertices' normals and the triangle.
RefineMesh to_refine_mesh(TileMesh tile);

// The blocks by whose counts tiles are planned: cubes of 16 cells a side. A triangle belongs to the
// block of its first corner.
inline constexpr int tile_block_level = 4;
CubeLattice tile_blocks(const RefineFrame& frame);

// Its code: of the block's lowest finest cell.
std::uint64_t block_code(const RefineMesh& mesh, std::size_t triangle, const CubeLattice& blocks);
// How many triangles belong to each block, as polygons; ascending by code.
std::vector<CubeCount> count_blocks(const RefineMesh& mesh, const CubeLattice& blocks);

// Whether the block of the triangle lies in the tile.
bool belongs_to(const RefineMesh& mesh, std::size_t triangle, const CubeLattice& blocks,
                CellKey tile);

// The tile of these triangles: by block and then by ids, whatever their order is here, vertices by
// first use. lattice: of the files. Cut into tiles or not, all triangles have one order.
TileMesh to_tile_mesh(const RefineMesh& mesh, CellKey tile, const OutputLattice& lattice,
                      const CubeLattice& blocks);

// Bytes to_tile_mesh takes at most, its result included.
std::uint64_t retile_bytes(std::uint64_t vertices, std::uint64_t triangles,
                           std::uint64_t sided = 0);

}  // namespace voxweld
