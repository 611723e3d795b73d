#include "tests/pipeline/run/mesh_scene.h"

#include <fmt/format.h>

#include <fstream>

#include "pipeline/output/load.h"
#include "storage/support/file_io.h"
#include "storage/support/hash.h"
#include "tests/support/temp_directory.h"

namespace voxweld::testing {

namespace fs = std::filesystem;

void write_off(const fs::path& path, const TriangleMesh& mesh) {
  std::ofstream out(path);
  out << fmt::format("OFF\n{} {} 0\n", mesh.vertices.size(), mesh.triangles.size());
  for (const Vec3& v : mesh.vertices) out << fmt::format("{} {} {}\n", v.x, v.y, v.z);
  for (const auto& t : mesh.triangles) out << fmt::format("3 {} {} {}\n", t[0], t[1], t[2]);
}

fs::path shared_mesh(const std::string& name) {
  const fs::path path = testing::shared_data(name);
  return fs::exists(path) ? path : fs::path();
}

TriangleMesh welded_mesh(const fs::path& path, Vec3 by) {
  MeshWelder mesh;
  mesh.add(load_mesh(path), by);
  return mesh.mesh();
}

MeshInputScene::MeshInputScene() : scene_(RawVolume{{1, 1, 1}, SampleType::u8, {std::byte{}}, 1}) {}

void MeshInputScene::set(const fs::path& mesh, const std::string& input,
                         const std::string& more) const {
  std::ofstream(scene_.config()) << fmt::format(
      "[input]\npath = '{}'\n{}\n[simplify]\nrefine = \"off\"\n[run]\nthreads = 2\n{}\n",
      mesh.string(), input, more);
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
