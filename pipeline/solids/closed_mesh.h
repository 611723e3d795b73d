// Meshes from files as solids: what inputs and edits of that kind are made of.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "pipeline/config/config.h"
#include "stages/solids/lattice_solid.h"
#include "stages/solids/mesh_boundary.h"
#include "storage/meshes/mesh_file.h"

namespace voxweld {

// InputError or FormatError for a file that is missing, damaged or too large for a budget of so
// many bytes, and for a mesh that is not closed where it has to be.
MeshFile read_closed_mesh(const std::filesystem::path& path, std::uint64_t budget,
                          MeshClosing closing);

// Whether reading, checking and indexing the file takes no more than a budget of so many bytes. The
// answer is the same in every process.
bool mesh_fits(const std::filesystem::path& path, std::uint64_t budget, MeshClosing closing);

// mesh: of the file, in its place in the frame.
std::shared_ptr<const LatticeSolid> make_solid(const TriangleMesh& mesh, const VolumeFrame& frame,
                                               Hash128 content, MeshClosing closing);

// InputError: the mesh of this file is not closed. edges: how many of it are odd; where: as
// holes_text has it.
[[noreturn]] void refuse_open_mesh(const std::filesystem::path& path, std::uint64_t edges,
                                   const std::string& where, const std::string& advice);

// Where the mesh is open, the largest holes first: "2 holes (...)". Precondition: it is.
std::string holes_text(const MeshBoundary& boundary);

}  // namespace voxweld
