#include "pipeline/solids/edit_meshes.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "pipeline/solids/closed_mesh.h"
#include "stages/solids/mesh_solid.h"
#include "storage/support/error.h"

namespace voxweld {
namespace {

namespace fs = std::filesystem;

// From the mesh's own coordinates to the frame spacing * index.
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

std::string bounds_text(const Bounds& b, Vec3 first) {
  const Vec3 lo = b.lo + first, hi = b.hi + first;
  return fmt::format("[{:.6g}, {:.6g}, {:.6g}] to [{:.6g}, {:.6g}, {:.6g}]", lo.x, lo.y, lo.z, hi.x,
                     hi.y, hi.z);
}

void warn_outside(const fs::path& path, const Solid& solid, const VolumeGeometry& geometry) {
  const VolumeFrame frame{geometry.size, geometry.spacing};
  const Bounds volume{{}, frame.place_of_sample(frame.size - splat(1))};
  if (relation_to(solid, volume) != Relation::outside) return;
  spdlog::warn("{}: the mesh lies outside of the volume: it is at {}, the volume at {}",
               path.string(), bounds_text(solid.mesh->bounds(), geometry.first),
               bounds_text(volume, geometry.first));
}

}  // namespace

void load_edit_meshes(const Config& config, const VolumeGeometry& geometry, Edits& edits) {
  const VolumeFrame frame{geometry.size, geometry.spacing};
  std::map<std::pair<fs::path, MeshClosing>, MeshFile> files;  // one may stand in several places
  for (std::size_t i = 0; i < edits.size(); ++i) {
    Solid& solid = edits[i].solid;
    if (solid.shape != SolidShape::mesh) continue;
    const EditConfig& edit = config.edits[i];
    const auto key = std::pair(edit.path, edit.close);
    auto found = files.find(key);
    if (found == files.end())
      found = files.emplace(key, read_closed_mesh(edit.path, config.run.memory, edit.close)).first;
    const TriangleMesh mesh = placed(found->second.mesh, solid);
    check_reach(edit.path, mesh, frame);
    solid.mesh = make_solid(mesh, frame, found->second.content, edit.close);
    warn_outside(edit.path, solid, geometry);
  }
}

}  // namespace voxweld
