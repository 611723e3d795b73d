// Meshes of the shared data as the input, at 256 cells and the defaults: closed, 2-manifold, near
// the mesh that went in, and sharp where it is. At other resolutions: tests/mesh_acceptance.sh.
#include <fmt/format.h>

#include "pipeline/output/verify.h"
#include "storage/meshes/mesh_file.h"
#include "tests/pipeline/run/mesh_scene.h"
#include "tests/support/test_names.h"

namespace voxweld::testing {
namespace {

struct Expected {
  const char* file;
  double mean;  // at most, in cells, of vertices to the mesh and back
  double most;
  // At least, of points on sharp edges, the share within a tenth of a cell, at the default
  // tolerance of a tenth and at a fiftieth; 0: none.
  double sharp, sharp_fine;
  double refined, refined_fine;  // the same with collapsed edges
};
void PrintTo(const Expected& expected, std::ostream* out) {
  *out << expected.file;
}
class MeshAcceptance : public ::testing::TestWithParam<Expected> {};

double share_near(const std::vector<Vec3>& points, const TriangleMesh& result, double cell) {
  const Spread edges = distances(points, sharp_edges(result, 20), cell);
  fmt::print("  {} points of sharp edges: {:.2f} % within 0.1 cells, mean {:.4f}, at most {:.3f}\n",
             edges.count, 100 * edges.share(), edges.mean(), edges.most);
  return edges.share();
}

TEST_P(MeshAcceptance, ComesOutAsItWentIn) {
  const std::filesystem::path path = shared_mesh(GetParam().file);
  if (path.empty()) GTEST_SKIP() << GetParam().file << " is not there";
  const TriangleMesh mesh = read_mesh_file(path).mesh;
  const MeshInputScene space;
  space.set(path, "resolution = 256");
  const TriangleMesh result = space.result();
  const VerifyReport report = expect_good(space.scene().output());
  EXPECT_EQ(report.boundary_edges, 0U);
  const double cell =
      manifest_of(space.scene().output()).at("frame").at("spacing").at(0).get<double>();
  const double volume = std::abs(volume_of(mesh));
  EXPECT_NEAR(volume_of(result), volume, 5e-4 * volume);
  const Spread away = distances(result.vertices, mesh, cell);
  const Spread missed = distances(mesh.vertices, result, cell);
  fmt::print(
      "{}: {} triangles; volume {:+.4f} %; vertices off by {:.4f}, at most {:.3f}; the mesh's "
      "by {:.4f}, at most {:.3f}\n",
      GetParam().file, result.triangles.size(), 100 * (volume_of(result) / volume - 1), away.mean(),
      away.most, missed.mean(), missed.most);
  EXPECT_LT(away.mean(), GetParam().mean);
  EXPECT_LT(missed.mean(), GetParam().mean);
  EXPECT_LT(away.most, GetParam().most);
  EXPECT_LT(missed.most, GetParam().most);
  if (GetParam().sharp == 0) return;
  const auto points = points_on(sharp_edges(mesh, 40), cell);
  const auto share = [&](const Settings& settings) {
    return share_near(points, space.result(settings), cell);
  };
  const std::string fine = "simplify.tolerance=0.02", refined = "simplify.refine=auto";
  EXPECT_GT(share_near(points, result, cell), GetParam().sharp);
  EXPECT_GT(share({fine}), GetParam().sharp_fine);
  EXPECT_GT(share({refined}), GetParam().refined);
  EXPECT_GT(share({fine, refined}), GetParam().refined_fine);
}

INSTANTIATE_TEST_SUITE_P(
    Shared, MeshAcceptance,
    ::testing::Values(Expected{"meshes/fandisk.obj", 0.03, 0.7, 0.91, 0.997, 0.86, 0.996},
                      Expected{"meshes/rocker-arm.obj", 0.05, 1, 0, 0, 0, 0},
                      Expected{"meshes/anchor_dense.off", 0.03, 0.5, 0.93, 0.997, 0.905, 0.995},
                      Expected{"meshes/joint.off", 0.03, 0.5, 0.955, 0.9999, 0.935, 0.985},
                      Expected{"meshes/knot2.off", 0.04, 0.5, 0.95, 0.975, 0.96, 0.98}),
    [](const auto& tested) { return test_name(tested.param.file); });

}  // namespace
}  // namespace voxweld::testing
