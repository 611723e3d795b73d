// Merged meshes that were written without holding them are checked so too.
#pragma once

#include <filesystem>
#include <functional>

#include "pipeline/output/verify.h"
#include "stages/encode/lattice_mesh.h"

namespace voxweld {

// Of a .ply, .stl, .obj or .vtp whose points lie on the lattice: what digest says of its mesh. Takes 12 bytes
// for each vertex, and of an .stl nothing. between: called every few megabytes, to stop.
// FormatError for what is no such file.
TriangleDigest digest_of_file(const std::filesystem::path& path, const OutputLattice& lattice,
                              const std::function<void()>& between = {});

// Whether a file of `directory` has the triangles that the tiles have together.
std::vector<Problem> compare_streamed(const std::filesystem::path& directory,
                                      const std::string& path, const OutputLattice& lattice,
                                      const TriangleDigest& of_tiles,
                                      const std::function<void()>& between);

}  // namespace voxweld
