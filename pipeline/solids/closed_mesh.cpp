#include "pipeline/solids/closed_mesh.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>

#include "pipeline/stage/context.h"
#include "stages/solids/mesh_solid.h"
#include "stages/solids/wound_mesh.h"
#include "storage/support/error.h"
#include "storage/support/text_fields.h"

namespace voxweld {
namespace {

namespace fs = std::filesystem;

// Of memory at most, for each byte of a mesh's file, while it is read, checked and indexed: a
// triangle of a binary STL has 50 bytes there and up to 200 here; in a binary PLY, with its share
// of the vertices, 19 and up to 95. Winding numbers take 140 more.
std::uint64_t bytes_per_file_byte(const fs::path& path, MeshClosing closing) {
  const bool ply = lower(path.extension().string()) == ".ply";
  const std::uint64_t read = ply ? 5 : 4, wound = ply ? 8 : 3;
  return closing == MeshClosing::winding ? read + wound : read;
}

// At least what program_bytes says, and the same for all.
constexpr std::uint64_t bytes_of_program = std::uint64_t{40} << 20;

void check_memory(const fs::path& path, std::uint64_t budget, MeshClosing closing) {
  std::error_code error;
  const std::uintmax_t size = fs::file_size(path, error);
  if (error) return;  // the reader says it better
  const std::uint64_t need = program_bytes() + bytes_per_file_byte(path, closing) * size;
  if (need <= budget) return;
  throw InputError(fmt::format(
      "{}: run.memory = {} is not enough for this mesh of {}, which takes up to {}{}; raise "
      "run.memory or simplify the mesh",
      path.string(), exact_bytes(budget), readable_bytes(static_cast<double>(size)),
      readable_bytes(static_cast<double>(need)),
      closing == MeshClosing::winding
          ? ": winding numbers (close = \"winding\") are of all its triangles at once"
          : ""));
}

}  // namespace

bool mesh_fits(const fs::path& path, std::uint64_t budget, MeshClosing closing) {
  std::error_code error;
  const std::uintmax_t size = fs::file_size(path, error);
  return error || bytes_of_program + bytes_per_file_byte(path, closing) * size <= budget;
}

void refuse_open_mesh(const fs::path& path, std::uint64_t edges, const std::string& where,
                      const std::string& advice) {
  throw InputError(
      fmt::format("{}: the mesh is not closed, so it has no inside: {} of its edges have an odd "
                  "number of triangles, in {}; {}",
                  path.string(), edges, where, advice));
}

std::string holes_text(const MeshBoundary& boundary) {
  constexpr std::size_t most_told = 3;
  std::string text;
  for (std::size_t i = 0; i < std::min(most_told, boundary.holes.size()); ++i) {
    const MeshHole& hole = boundary.holes[i];
    text += fmt::format("{}one of {} edges, {:.6g} across, around [{:.6g}, {:.6g}, {:.6g}]",
                        i == 0 ? "" : "; ", hole.edges, hole.size, hole.center.x, hole.center.y,
                        hole.center.z);
  }
  return fmt::format("{} {} (in the file's own coordinates, the largest first: {})",
                     boundary.holes.size(), boundary.holes.size() == 1 ? "hole" : "holes", text);
}

MeshFile read_closed_mesh(const fs::path& path, std::uint64_t budget, MeshClosing closing) {
  check_memory(path, budget, closing);
  MeshFile file = read_mesh_file(path);
  const MeshBoundary boundary = boundary_of(file.mesh);
  if (closing == MeshClosing::winding) {
    if (!boundary.closed())
      spdlog::info("{}: closed by winding number: {}", path.string(), holes_text(boundary));
    return file;
  }
  if (!boundary.closed())
    refuse_open_mesh(path, boundary.edges, holes_text(boundary),
                     "close it in a mesh editor, or with close = \"winding\"");
  if (signed_volume(file.mesh) < 0)
    spdlog::warn("{}: its triangles face inward; the solid is what they enclose all the same",
                 path.string());
  return file;
}

std::shared_ptr<const LatticeSolid> make_solid(const TriangleMesh& mesh, const VolumeFrame& frame,
                                               Hash128 content, MeshClosing closing) {
  if (closing == MeshClosing::no) return std::make_shared<MeshSolid>(mesh, frame, content);
  return std::make_shared<WoundMesh>(mesh, frame, content);
}

}  // namespace voxweld
