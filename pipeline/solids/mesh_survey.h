// Checks a mesh that does not fit memory: that it is closed, and which way it faces.
#pragma once

#include "pipeline/config/config.h"
#include "pipeline/solids/spooled_mesh.h"

namespace voxweld {

// A line to the log every five seconds, for work that is in no stage.
MeshWork::Progress progress_lines(const std::filesystem::path& path);

// InputError for one that is not closed, with its holes as read_closed_mesh tells them
// (closed_mesh.h), or their first edges where they are too many for the memory. Warns of one that
// faces inward.
void check_spooled_mesh(const std::filesystem::path& path, const SpooledMesh& mesh,
                        const MeshWork& work);

struct MeshSummary {
  std::string format;  // as MeshFile has it
  std::uint64_t vertices = 0, triangles = 0;
  Bounds bounds;  // of its triangles
};

// Reads a mesh and checks it: in memory where a budget of so many bytes is enough for that, else
// by pieces; then vertices are as the file has them. folder: for scratch files.
// InputError or FormatError as read_closed_mesh and check_spooled_mesh.
MeshSummary summary_of_mesh(const std::filesystem::path& path, std::uint64_t budget,
                            MeshClosing closing, const std::filesystem::path& folder);

}  // namespace voxweld
