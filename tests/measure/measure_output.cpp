// How far a finished output lies from the true surface of a phantom.
// usage: measure_output OUTPUT_DIR KIND SIZE
// Prints, in voxels: vertices max mean p99, points inside the triangles max mean p99; and how many
// edges turn by over 150 degrees.
#include <fmt/format.h>

#include <cstdio>
#include <cstdlib>

#include "pipeline/output/load.h"
#include "storage/manifest/manifest.h"
#include "storage/support/error.h"
#include "tests/support/mesh_fidelity.h"
#include "tests/support/phantom_distance.h"

int main(int argc, char** argv) try {
  using namespace voxweld;
  if (argc != 4) {
    fmt::print(stderr, "usage: measure_output OUTPUT_DIR KIND SIZE\n");
    return 2;
  }
  const auto field = make_analytic_field(parse_phantom_kind(argv[2]), std::atoll(argv[3]));
  const Manifest manifest = read_manifest(std::filesystem::path(argv[1]) / manifest_name);
  const Vec3 spacing = manifest.frame.spacing;
  std::vector<std::array<float, 3>> points;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  testing::WeldedMesh welded;
  for_each_mesh(argv[1], [&](const DecodedMesh& mesh, auto) {
    const auto base = static_cast<std::uint32_t>(points.size());
    for (const auto& p : mesh.positions)
      points.push_back({static_cast<float>(static_cast<double>(p[0]) / spacing.x),
                        static_cast<float>(static_cast<double>(p[1]) / spacing.y),
                        static_cast<float>(static_cast<double>(p[2]) / spacing.z)});
    for (const auto& t : mesh.triangles)
      triangles.push_back({t[0] + base, t[1] + base, t[2] + base});
    welded.add(mesh);
  });
  const MeshDistance d = measure_mesh(*field, points, triangles);
  fmt::print(
      "{} {}: {} triangles; vertices max {:.3f} mean {:.4f} p99 {:.3f}; triangles max {:.3f} mean "
      "{:.4f} p99 {:.3f}; {} folded edges\n",
      argv[2], argv[3], triangles.size(), d.vertices.max, d.vertices.mean, d.vertices.p99,
      d.triangles.max, d.triangles.mean, d.triangles.p99, testing::folded_edges(welded.mesh()));
  return 0;
} catch (const voxweld::Error& error) {
  fmt::print(stderr, "{}\n", error.what());
  return error.exit_code();
}
