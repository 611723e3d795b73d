#include "pipeline/run/edit_meshes.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "pipeline/run/context.h"
#include "stages/geometry/mesh_boundary.h"
#include "stages/geometry/mesh_solid.h"
#include "storage/readers/mesh_file.h"
#include "storage/support/error.h"

namespace voxweld {
namespace {

namespace fs = std::filesystem;

// Of memory at most, for each byte of a mesh's file, while it is read, checked and indexed: a
// triangle of a binary STL has 50 bytes there and up to 200 here.
constexpr std::uint64_t bytes_per_file_byte = 4;

void check_memory(const fs::path& path, std::uint64_t budget) {
  std::error_code error;
  const std::uintmax_t size = fs::file_size(path, error);
  if (error) return;  // the reader says it better
  const std::uint64_t need = program_bytes() + bytes_per_file_byte * size;
  if (need <= budget) return;
  throw InputError(fmt::format(
      "{}: run.memory = {} is not enough for this mesh of {}, which takes up to {}; raise "
      "run.memory or simplify the mesh",
      path.string(), exact_bytes(budget), readable_bytes(static_cast<double>(size)),
      readable_bytes(static_cast<double>(need))));
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
  return text;
}

void check_closed(const fs::path& path, const TriangleMesh& mesh) {
  const MeshBoundary boundary = boundary_of(mesh);
  if (boundary.closed()) return;
  throw InputError(fmt::format(
      "{}: the mesh is not closed, so it has no inside: {} of its edges have an odd number of "
      "triangles, in {} {} (in the file's own coordinates, the largest first: {}); close it in a "
      "mesh editor",
      path.string(), boundary.edges, boundary.holes.size(),
      boundary.holes.size() == 1 ? "hole" : "holes", holes_text(boundary)));
}

MeshFile read_closed(const fs::path& path, std::uint64_t budget) {
  check_memory(path, budget);
  MeshFile file = read_mesh_file(path);
  check_closed(path, file.mesh);
  if (signed_volume(file.mesh) < 0)
    spdlog::warn("{}: its triangles face inward; the solid is what they enclose all the same",
                 path.string());
  return file;
}

// From the mesh's own coordinates to the output's.
TriangleMesh placed(const TriangleMesh& mesh, const Solid& solid) {
  TriangleMesh result = mesh;
  for (Vec3& v : result.vertices) {
    const Vec3 q = v * solid.scale;
    v = solid.center + (solid.axes[0] * q.x + solid.axes[1] * q.y + solid.axes[2] * q.z);
  }
  return result;
}

void check_reach(const fs::path& path, const TriangleMesh& mesh, const VolumeFrame& frame) {
  double furthest = 0;
  for (const Vec3& v : mesh.vertices)
    for (int a = 0; a < 3; ++a) furthest = std::max(furthest, std::abs(v[a]) / frame.spacing[a]);
  if (furthest < MeshSolid::reach) return;
  throw InputError(fmt::format(
      "{}: the mesh reaches {:.6g} voxels from the volume's first sample; expected less than {}; "
      "check the mesh's unit, scale and center",
      path.string(), furthest, MeshSolid::reach));
}

void warn_outside(const fs::path& path, const Solid& solid, const VolumeFrame& frame) {
  const Bounds volume{{}, frame.place_of_sample(frame.size - splat(1))};
  if (relation_to(solid, volume) != Relation::outside) return;
  const Bounds b = solid.mesh->bounds();
  spdlog::warn(
      "{}: the mesh lies outside of the volume: it is at [{:.6g}, {:.6g}, {:.6g}] to [{:.6g}, "
      "{:.6g}, {:.6g}], the volume at [0, 0, 0] to [{:.6g}, {:.6g}, {:.6g}]",
      path.string(), b.lo.x, b.lo.y, b.lo.z, b.hi.x, b.hi.y, b.hi.z, volume.hi.x, volume.hi.y,
      volume.hi.z);
}

}  // namespace

void load_edit_meshes(const Config& config, const VolumeFrame& frame, Edits& edits) {
  std::map<fs::path, MeshFile> files;  // one may stand in several places
  for (std::size_t i = 0; i < edits.size(); ++i) {
    Solid& solid = edits[i].solid;
    if (solid.shape != SolidShape::mesh) continue;
    const fs::path& path = config.edits[i].path;
    auto found = files.find(path);
    if (found == files.end())
      found = files.emplace(path, read_closed(path, config.run.memory)).first;
    const TriangleMesh mesh = placed(found->second.mesh, solid);
    check_reach(path, mesh, frame);
    solid.mesh = std::make_shared<MeshSolid>(mesh, frame, found->second.content);
    warn_outside(path, solid, frame);
  }
}

}  // namespace voxweld
