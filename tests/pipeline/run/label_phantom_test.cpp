// Labels with exact interfaces, meshed: how far triangles lie from the interface of their pair.
#include <fmt/format.h>

#include "pipeline/output/load.h"
#include "pipeline/phantom/junctions_field.h"
#include "storage/types/label_range.h"
#include "tests/pipeline/run/scene.h"

namespace voxweld::testing {
namespace {

constexpr std::int64_t n = 96;
constexpr std::uint64_t first_id = highest_label - 6;  // ids that only 64 bits hold

// Of the phantom's labels; what is outside is 0 there.
std::uint64_t label_of(Material material) {
  return material == exterior ? 0 : material - first_id + 1;
}

struct Distances {
  double sum = 0, most = 0, off_curves = 0;
  std::uint64_t count = 0;
};

TEST(LabelPhantom, TrianglesLieOnTheInterfaceOfTheirPair) {
  const Scene scene("sphere", 8);  // for its folders
  const std::string volume = (scene.directory() / "junctions.nrrd").string();
  VOXWELD_EXPECT_DONE(
      run_voxweld({"phantom", "junctions", "--size", std::to_string(n), "--type", "uint64",
                   "--first-label", std::to_string(first_id), "-o", volume}));
  VOXWELD_EXPECT_DONE(
      scene.run({"input.path=" + volume, "labels.mode=shared", "surface.inside=above"}));
  expect_good(scene.output());
  const DecodedMesh mesh = load_mesh(scene.output() / "mesh.drc");
  ASSERT_EQ(mesh.triangle_pairs.size(), mesh.triangles.size());
  const JunctionsField field(n);
  Distances vertices;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const MaterialPair pair = mesh.pairs[mesh.triangle_pairs[t]];
    for (const std::uint32_t corner : mesh.triangles[t]) {
      const auto& p = mesh.positions[corner];
      const Vec3 at{p[0], p[1], p[2]};
      const double d = field.interface_distance(at, label_of(pair.inside), label_of(pair.outside));
      vertices.sum += d;
      vertices.most = std::max(vertices.most, d);
      if (field.curve_distance(at) > 3) vertices.off_curves = std::max(vertices.off_curves, d);
      ++vertices.count;
    }
  }
  fmt::print("mean {:.4f}, most {:.4f}, away from curves {:.4f} voxels\n",
             vertices.sum / static_cast<double>(vertices.count), vertices.most,
             vertices.off_curves);
  EXPECT_LT(vertices.sum / static_cast<double>(vertices.count), 0.15);
  EXPECT_LT(vertices.off_curves, 0.6);
  EXPECT_LT(vertices.most, 1.5);
}

}  // namespace
}  // namespace voxweld::testing
