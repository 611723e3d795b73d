#include "tests/pipeline/run/mesh_scene.h"

#include <fmt/format.h>

#include <array>
#include <fstream>
#include <map>

#include "pipeline/mesh/load.h"
#include "storage/support/file_io.h"
#include "storage/support/hash.h"
#include "tests/support/nearest_triangle.h"

namespace voxweld::testing {

namespace fs = std::filesystem;

void write_off(const fs::path& path, const TriangleMesh& mesh) {
  std::ofstream out(path);
  out << fmt::format("OFF\n{} {} 0\n", mesh.vertices.size(), mesh.triangles.size());
  for (const Vec3& v : mesh.vertices) out << fmt::format("{} {} {}\n", v.x, v.y, v.z);
  for (const auto& t : mesh.triangles) out << fmt::format("3 {} {} {}\n", t[0], t[1], t[2]);
}

fs::path shared_mesh(const std::string& name) {
  const fs::path path = fs::path(VOXWELD_SHARED_DATA) / name;
  return fs::exists(path) ? path : fs::path();
}

TriangleMesh welded_mesh(const fs::path& path, Vec3 by) {
  const DecodedMesh decoded = load_mesh(path);
  TriangleMesh mesh;
  std::map<std::array<double, 3>, std::uint32_t> known;
  std::vector<std::uint32_t> becomes;
  for (const auto& p : decoded.positions) {
    const Vec3 v = Vec3{p[0], p[1], p[2]} + by;
    const auto [found, added] =
        known.try_emplace({v.x, v.y, v.z}, static_cast<std::uint32_t>(mesh.vertices.size()));
    if (added) mesh.vertices.push_back(v);
    becomes.push_back(found->second);
  }
  for (const auto& t : decoded.triangles)
    mesh.triangles.push_back({becomes[t[0]], becomes[t[1]], becomes[t[2]]});
  return mesh;
}

Spread distances(const std::vector<Vec3>& points, const TriangleMesh& mesh, double cell) {
  const NearestTriangle nearest(mesh, 2 * cell);
  Spread spread;
  for (const Vec3& p : points) spread.add(nearest.distance_to(p) / cell, 0.1);
  return spread;
}

std::vector<Vec3> points_on(const TriangleMesh& edges, double cell) {
  std::vector<Vec3> points;
  for (const auto& t : edges.triangles) {
    const Vec3 a = edges.vertices[t[0]], b = edges.vertices[t[1]];
    const int count = 1 + static_cast<int>(std::sqrt(dot(b - a, b - a)) / (0.5 * cell));
    for (int i = 0; i < count; ++i) points.push_back(a + (b - a) * ((i + 0.5) / count));
  }
  return points;
}

MeshInputScene::MeshInputScene() : scene_(RawVolume{{1, 1, 1}, SampleType::u8, {std::byte{}}, 1}) {}

void MeshInputScene::set(const fs::path& mesh, const std::string& input,
                         const std::string& more) const {
  std::ofstream(scene_.config()) << fmt::format(
      "[input]\npath = '{}'\n{}\n[run]\nthreads = 2\n{}\n", mesh.string(), input, more);
}

TriangleMesh MeshInputScene::result(const Settings& settings) const {
  VOXWELD_EXPECT_DONE(scene_.run(settings));
  return welded_mesh(scene_.output() / "mesh.drc");
}

std::string MeshInputScene::bytes(const Settings& settings) const {
  VOXWELD_EXPECT_DONE(scene_.run(settings));
  return to_hex(hash_bytes(read_whole_file(scene_.output() / "mesh.drc")));
}

}  // namespace voxweld::testing
