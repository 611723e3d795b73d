#include "pipeline/run/closed_mesh.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>

#include "pipeline/run/context.h"
#include "storage/readers/text_fields.h"
#include "storage/support/error.h"

namespace voxweld {
namespace {

namespace fs = std::filesystem;

// Of memory at most, for each byte of a mesh's file, while it is read, checked and indexed: a
// triangle of a binary STL has 50 bytes there and up to 200 here; in a binary PLY, with its share
// of the vertices, 19 and up to 95.
std::uint64_t bytes_per_file_byte(const fs::path& path) {
  return lower(path.extension().string()) == ".ply" ? 5 : 4;
}

void check_memory(const fs::path& path, std::uint64_t budget) {
  std::error_code error;
  const std::uintmax_t size = fs::file_size(path, error);
  if (error) return;  // the reader says it better
  const std::uint64_t need = program_bytes() + bytes_per_file_byte(path) * size;
  if (need <= budget) return;
  throw InputError(fmt::format(
      "{}: run.memory = {} is not enough for this mesh of {}, which takes up to {}; raise "
      "run.memory or simplify the mesh",
      path.string(), exact_bytes(budget), readable_bytes(static_cast<double>(size)),
      readable_bytes(static_cast<double>(need))));
}

}  // namespace

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

MeshFile read_closed_mesh(const fs::path& path, std::uint64_t budget) {
  check_memory(path, budget);
  MeshFile file = read_mesh_file(path);
  const MeshBoundary boundary = boundary_of(file.mesh);
  if (!boundary.closed())
    throw InputError(fmt::format(
        "{}: the mesh is not closed, so it has no inside: {} of its edges have an odd number of "
        "triangles, in {}; close it in a mesh editor",
        path.string(), boundary.edges, holes_text(boundary)));
  if (signed_volume(file.mesh) < 0)
    spdlog::warn("{}: its triangles face inward; the solid is what they enclose all the same",
                 path.string());
  return file;
}

}  // namespace voxweld
