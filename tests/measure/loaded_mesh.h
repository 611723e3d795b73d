// A mesh to be measured: an output of voxweld's, or a mesh file of any other program.
#pragma once

#include <filesystem>
#include <vector>

#include "storage/types/output_lattice.h"
#include "storage/types/triangle_mesh.h"

namespace voxweld {

struct LoadedMesh {
  // In sample indices. Of an output each tile's vertices, one for each of its normals; of a file its
  // own.
  TriangleMesh mesh;
  // The lattice on which exact tests are done: an output's own; that of a file has steps of 2^-10
  // of a sample, to which its vertices have to be rounded.
  Vec3 lattice_origin, lattice_step;
  bool rounded = false;
};

// A mesh file (.ply, .obj, .stl or .off) has sample indices already. Errors as those who read it.
LoadedMesh load_to_measure(const std::filesystem::path& path);

// The nearest points of the loaded mesh's lattice. InputError where that takes over 22 bits.
std::vector<LatticePoint> on_lattice(const LoadedMesh& loaded, const std::vector<Vec3>& vertices);

}  // namespace voxweld
