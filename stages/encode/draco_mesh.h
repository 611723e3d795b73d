// Between tile meshes and Draco's own: used by draco_codec alone.
#pragma once

#include <draco/mesh/mesh.h>

#include <string>

#include "stages/encode/draco_codec.h"
#include "storage/types/tile_mesh.h"

namespace voxweld {

struct DracoAttributes {
  int position = 0;
  int normal = -1;  // -1: none
  int pair = -1;
};

// Precondition: the mesh is one that encode_draco takes.
DracoAttributes fill_draco_mesh(const TileMesh& mesh, bool normals, draco::Mesh& out);

std::array<float, 3> lattice_point(const OutputLattice& lattice, const LatticePoint& q);

// Fills pairs and triangle_pairs where the mesh has them. FormatError, starting with `where`.
void read_pairs(const draco::Mesh& mesh, DecodedMesh& out, const std::string& where);

}  // namespace voxweld
