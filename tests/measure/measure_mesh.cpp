// How near the output of a run comes to the mesh that was its input.
// usage: measure_mesh MESH OUTPUT_DIR [WORST]
// Prints, in cells: distances of the output's vertices to the mesh and of the mesh's to the output,
// and of points on edges that turn by over 40 degrees to those of the output that turn by over 20;
// of these the WORST farthest with their places. And how many edges turn by over 150.
#include <fmt/format.h>

#include <cstdio>
#include <cstdlib>

#include "pipeline/output/load.h"
#include "storage/manifest/manifest.h"
#include "storage/meshes/mesh_file.h"
#include "storage/support/error.h"
#include "tests/support/mesh_fidelity.h"

namespace voxweld {
namespace {

using namespace testing;

std::string text(const Spread& s) {
  return fmt::format("mean {:.4f}, most {:.3f}, {:.2f} % within 0.1", s.mean(), s.most,
                     100 * s.share());
}

void list_worst(const std::vector<Vec3>& points, const TriangleMesh& mesh, double cell,
                std::size_t count) {
  const TriangleTree tree(mesh);
  std::vector<std::pair<double, Vec3>> all;
  all.reserve(points.size());
  for (const Vec3& p : points) all.emplace_back(tree.distance_to(p) / cell, p);
  std::stable_sort(all.begin(), all.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  for (std::size_t i = 0; i < std::min(count, all.size()); ++i)
    fmt::print("  {:.3f} at [{:.6g}, {:.6g}, {:.6g}]\n", all[i].first, all[i].second.x,
               all[i].second.y, all[i].second.z);
}

void measure(const std::filesystem::path& source, const std::filesystem::path& output,
             std::size_t worst) {
  const TriangleMesh mesh = read_mesh_file(source).mesh;
  const Manifest manifest = read_manifest(output / manifest_name);
  const double cell = manifest.frame.spacing.x;
  MeshWelder result;
  for_each_mesh(output,
                [&](const DecodedMesh& part, auto) { result.add(part, manifest.frame.origin); });
  const double volume = std::abs(volume_of(mesh));
  fmt::print("{} triangles to {}; volume {:+.5f} %\n", mesh.triangles.size(),
             result.mesh().triangles.size(), 100 * (volume_of(result.mesh()) / volume - 1));
  fmt::print("output's vertices to the mesh: {}\n",
             text(distances(result.mesh().vertices, mesh, cell)));
  fmt::print("mesh's vertices to the output: {}\n",
             text(distances(mesh.vertices, result.mesh(), cell)));
  fmt::print("folded edges: {}, of the mesh itself {}\n", folded_edges(result.mesh()),
             folded_edges(mesh));
  const auto points = points_on(sharp_edges(mesh, 40), cell);
  if (points.empty()) return;
  const TriangleMesh edges = sharp_edges(result.mesh(), 20);
  fmt::print("{} points of sharp edges to the output's: {}\n", points.size(),
             text(distances(points, edges, cell)));
  list_worst(points, edges, cell, worst);
}

}  // namespace
}  // namespace voxweld

int main(int argc, char** argv) try {
  if (argc != 3 && argc != 4) {
    fmt::print(stderr, "usage: measure_mesh MESH OUTPUT_DIR [WORST]\n");
    return 2;
  }
  voxweld::measure(argv[1], argv[2], argc == 4 ? static_cast<std::size_t>(std::atoll(argv[3])) : 0);
  return 0;
} catch (const voxweld::Error& error) {
  fmt::print(stderr, "{}\n", error.what());
  return error.exit_code();
}
