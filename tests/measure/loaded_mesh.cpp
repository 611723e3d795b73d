#include "tests/measure/loaded_mesh.h"

#include <fmt/format.h>

#include <cmath>

#include "pipeline/output/load.h"
#include "storage/manifest/manifest.h"
#include "storage/meshes/mesh_file.h"
#include "storage/support/error.h"

namespace voxweld {
namespace {

constexpr double rounded_to = 0x1p-10;  // of a sample

// All that the file has: read_mesh_file() into memory would drop what is degenerate.
class EverythingSink : public MeshSink {
 public:
  explicit EverythingSink(TriangleMesh& mesh) : mesh_(mesh) {}
  void vertex(Vec3 place) override { mesh_.vertices.push_back(place); }
  void triangle(const std::array<std::uint64_t, 3>& corners) override {
    auto& t = mesh_.triangles.emplace_back();
    for (std::size_t i = 0; i < 3; ++i) t[i] = static_cast<std::uint32_t>(corners[i]);
  }
  void facet(const std::array<Vec3, 3>& corners) override {
    const auto first = static_cast<std::uint32_t>(mesh_.vertices.size());
    mesh_.vertices.insert(mesh_.vertices.end(), corners.begin(), corners.end());
    mesh_.triangles.push_back({first, first + 1, first + 2});
  }

 private:
  TriangleMesh& mesh_;
};

Vec3 divided(Vec3 a, Vec3 b) {
  return {a.x / b.x, a.y / b.y, a.z / b.z};
}

LoadedMesh load_output(const std::filesystem::path& path) {
  const Manifest manifest = read_manifest(path / manifest_name);
  const VolumeGeometry& frame = manifest.frame;
  const auto in_samples = [&](Vec3 p) { return divided(p - frame.first, frame.spacing); };
  LoadedMesh loaded;
  const auto& origin = manifest.lattice.origin;
  const double step = manifest.lattice.step;
  loaded.lattice_origin = in_samples({origin[0], origin[1], origin[2]});
  loaded.lattice_step = divided({step, step, step}, frame.spacing);
  TriangleMesh& to = loaded.mesh;
  for_each_mesh(path, [&](const DecodedMesh& mesh, auto) {
    const auto base = static_cast<std::uint32_t>(to.vertices.size());
    for (const auto& p : mesh.positions) to.vertices.push_back(in_samples({p[0], p[1], p[2]}));
    for (const auto& t : mesh.triangles)
      to.triangles.push_back({t[0] + base, t[1] + base, t[2] + base});
  });
  return loaded;
}

LoadedMesh load_file(const std::filesystem::path& path) {
  LoadedMesh loaded;
  EverythingSink sink(loaded.mesh);
  read_mesh_file(path, sink);
  if (loaded.mesh.triangles.empty())
    throw FormatError(fmt::format("{}: no triangles", path.string()));
  Vec3 least = loaded.mesh.vertices.front();
  for (const Vec3& v : loaded.mesh.vertices) least = min(least, v);
  loaded.lattice_origin = {std::floor(least.x), std::floor(least.y), std::floor(least.z)};
  loaded.lattice_step = {rounded_to, rounded_to, rounded_to};
  loaded.rounded = true;
  return loaded;
}

}  // namespace

LoadedMesh load_to_measure(const std::filesystem::path& path) {
  return is_mesh_name(path) && !std::filesystem::is_directory(path) ? load_file(path)
                                                                    : load_output(path);
}

std::vector<LatticePoint> on_lattice(const LoadedMesh& loaded, const std::vector<Vec3>& vertices) {
  std::vector<LatticePoint> points;
  points.reserve(vertices.size());
  for (const Vec3& v : vertices) {
    LatticePoint& q = points.emplace_back();
    const Vec3 at = divided(v - loaded.lattice_origin, loaded.lattice_step);
    for (int a = 0; a < 3; ++a) {
      if (!(at[a] < (1 << max_lattice_bits) - 0.5))
        throw InputError("the mesh is too large for exact tests of its intersections");
      q[static_cast<std::size_t>(a)] = static_cast<std::int32_t>(std::llround(at[a]));
    }
  }
  return points;
}

}  // namespace voxweld
